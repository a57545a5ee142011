// What pads are made of.
#pragma once

#include <cstdint>
#include <memory>

#include "sim/core/sensor.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/scene.h"

namespace slipbench {

// sim/ knows no sensor: whoever composes a program or the plugin's library hands them in.
struct PadCatalogue {
  Catalogues catalogues;
  // Throws InputError when the sensor cannot be as the scene says.
  std::unique_ptr<Sensor> (*make_sensor)(const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) = nullptr;
};

}  // namespace slipbench
