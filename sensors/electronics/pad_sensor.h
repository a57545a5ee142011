// Base of sensors that consist of one pad and a chain of electronics.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/api/sensor.h"

namespace slipbench {

class PadSensor : public Sensor {
 public:
  PadSensor(const PadSensor&) = delete;  // the frame points into the object
  PadSensor& operator=(const PadSensor&) = delete;

  [[nodiscard]] const PadLayout& layout() const final { return layout_; }
  [[nodiscard]] double rate() const final { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const final { return channels_; }

 protected:
  PadSensor(double rate, PadLayout layout, std::vector<Channel> channels)
      : rate_(rate), layout_(std::move(layout)), channels_(std::move(channels)) {}

  double rate_;
  PadLayout layout_;
  std::vector<Channel> channels_;
  SensorFrame frame_;
};

// Makes a sensor from its parameters and electronics. All trials of a dataset share one device
// unless the sensor's parameter `device` is `redrawn`.
template <class Made>
std::unique_ptr<Sensor> created(const Parameters& parameters, const std::vector<Named>& electronics, std::uint64_t seed,
                                std::uint64_t trial, const std::string& sensor_name) {
  const bool redrawn = parameters.values().contains("device") && parameters.choice("device") == "redrawn";
  return std::make_unique<Made>(parameters, electronics, ElectronicsKey{seed, trial, redrawn ? trial : 0, sensor_name});
}

}  // namespace slipbench
