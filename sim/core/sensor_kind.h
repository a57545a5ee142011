// A sensor as the catalogue has it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/core/parameters.h"
#include "sim/core/sensor_view.h"

namespace slipbench {

class Sensor;

struct SensorKind {
  Entry about;
  std::vector<Entry> electronics;  // the parts that it has
  // `parameters`: those of `about`, all present. `electronics`: applied in this order; empty: ideal. `seed` of the dataset and
  // `trial` key the random streams, together with `sensor_name`, the scene's name for the sensor. Throws InputError for what the
  // sensor refuses.
  std::unique_ptr<Sensor> (*create)(const Parameters& parameters, const std::vector<Named>& electronics, std::uint64_t seed,
                                    std::uint64_t trial, const std::string& sensor_name);
  SensorView view = {};
};

}  // namespace slipbench
