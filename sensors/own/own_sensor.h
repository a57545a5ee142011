// A sensor that somebody else has made, a library or a Python class: what it says of itself and of each sample, checked.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sensors/plugin_abi.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor.h"

namespace slipbench {

// What such a sensor says once.
struct OwnLayout {
  static constexpr std::size_t most_elements = 4096, most_channels = 64, most_dimensions = 8, most_values = 1'000'000;

  double rate = 0.0;  // Hz
  std::vector<Element> elements;
  std::vector<std::size_t> units;  // of each element: 0 of the first one, then the same or one more
  std::vector<Channel> channels;   // names, units and shapes
};

class OwnSensor : public Sensor {
 public:
  OwnSensor(const OwnSensor&) = delete;  // the frame points into the object
  OwnSensor& operator=(const OwnSensor&) = delete;

  [[nodiscard]] const PadLayout& layout() const final { return layout_; }
  [[nodiscard]] double rate() const final { return rate_; }
  [[nodiscard]] const std::vector<Channel>& channels() const final { return channels_; }
  // Throws SceneValueError where read() does, and for a value that is not finite.
  const SensorFrame& measure(const ContactFrame& truth) final;
  // A sensor of one's own has no paper: the truth by the rule `strict`.
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool /*rotating*/) const final { return truth.state; }

 protected:
  // `where`: the scene's key that is to blame, "sensors.pad.library"; `whose`: who, "'mine.so'".
  OwnSensor(std::string where, std::string whose) : where_(std::move(where)), whose_(std::move(whose)) {}

  // To be called once, before the first measure(). Throws SceneValueError for a layout that cannot be simulated and channels that no dataset can
  // hold: see README.md for what is allowed.
  void set(OwnLayout said);

  // Writes a sample, all channels in their order. `values` are NaN.
  virtual void read(const ContactFrame& truth, std::span<float> values) = 0;

  [[noreturn]] void refuse(const std::string& what) const;

 private:
  std::string where_, whose_;
  double rate_ = 0.0;
  PadLayout layout_;
  std::vector<Channel> channels_;
  std::vector<float> values_;
  SensorFrame frame_;
};

// A source written for sensors/plugin_abi.h alone that the program is built with, and what it exports.
struct BundledSensor {
  const char* type;  // the scene's name for it
  const slipbench_parameter* parameters;
  const slipbench_about* about;
  void (*make)(const slipbench_source* source, slipbench_readout* readout);
};

// The declared parameters as the scene's parser takes them, each with its note.
std::vector<ParameterSpec> specs_of(const BundledSensor& bundled);

// The sensor `name` of a scene, as SensorKind::create has it. What it throws and says is checked as of a library; SceneValueError is then
// at sensors.`name`.type.
std::unique_ptr<Sensor> make_bundled(const BundledSensor& bundled, const Parameters& parameters, std::uint64_t seed,
                                     std::uint64_t trial, const std::string& name);

}  // namespace slipbench
