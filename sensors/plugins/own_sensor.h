// A custom sensor, from a shared library or a Python class. Its layout and each sample are checked.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "sensors/plugin_abi.h"
#include "sim/api/sensor.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Layout of a custom sensor, as the library or class declares it.
struct OwnLayout {
  static constexpr std::size_t most_elements = 4096, most_channels = 64, most_dimensions = 8, most_values = 1'000'000;

  double rate = 0.0;  // Hz
  std::vector<Element> elements;
  std::vector<std::size_t> units;  // of each element: 0 for the first one, then equal or +1
  std::vector<Channel> channels;   // names, units and shapes
};

class OwnSensor : public Sensor {
 public:
  OwnSensor(const OwnSensor&) = delete;  // the frame points into the object
  OwnSensor& operator=(const OwnSensor&) = delete;

  [[nodiscard]] const PadLayout& layout() const final { return layout_; }
  [[nodiscard]] double rate() const final { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const final { return channels_; }
  // Throws SceneValueError if read() does, and for a value that is not finite.
  const SensorFrame& measure(const ContactFrame& truth) final;
  // Returns the truth by the rule `strict`, as a custom sensor has no paper.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const final { return truth.state; }

 protected:
  // `where`: key of the scene for errors, "sensors.pad.library"; `subject`: the sensor's source for
  // errors, "'mine.so'".
  OwnSensor(std::string where, std::string subject) : where_(std::move(where)), subject_(std::move(subject)) {}

  // Must be called once, before the first measure(). Throws SceneValueError for a layout that
  // cannot be simulated and for channels that a dataset cannot store (limits: README.md).
  void set(OwnLayout layout);

  // Writes one sample, all channels in order. `values` are NaN on entry.
  virtual void read(const ContactFrame& truth, std::span<float> values) = 0;

  [[noreturn]] void refuse(const std::string& what) const;

 private:
  std::string where_, subject_;
  double rate_ = 0.0;
  PadLayout layout_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  SensorFrame frame_;
};

}  // namespace slipbench
