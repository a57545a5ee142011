// An artificial sensor with many sources, so that a part's statistics can be taken over sources at
// one instant.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "sensors/electronics/electronics.h"

namespace slipbench {

inline constexpr std::size_t many = 20000;  // sources; standard error of a mean square: sqrt(2/many) = 1 %

// Two values per source: value v < sources has the disturbances 1; value sources + v follows the
// same source with three times the disturbances.
inline SignalModel two_values_a_source(std::size_t sources, double rate = 1000.0) {
  SignalModel model;
  model.rate = rate;
  model.sources = sources;
  for (const double size : {1.0, 3.0}) {
    for (std::size_t s = 0; s < sources; ++s) {
      model.source.push_back(s);
      model.noise_sd.push_back(size);
      model.offset_sd.push_back(size);
      model.drift_sd.push_back(size);
      model.gain_sd.push_back(0.1 * size);
      model.converter.push_back({-2.0 * size, 2.0 * size});
      model.valid.push_back({-2.0 * size, 2.0 * size});
    }
  }
  return model;
}

// All parts, in the order of the signal path.
inline std::vector<Entry> electronics_entries() {
  std::vector<PartFigures> parts;
  for (const char* name : {"low_pass", "scan", "coupling", "gain", "offset", "drift", "noise", "white_noise", "skewed_noise",
                           "quantisation", "valid_range"})
    parts.push_back({name, "made up"});
  return electronics_of("made up", parts);
}

// A part with its defaults, except `scale` if it has one.
inline Named part(const std::string& name, double scale = 1.0) {
  const std::vector<Entry> entries = electronics_entries();
  const auto entry = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == name; });
  Named result{name, entry == entries.end() ? Parameters{} : defaults_of(entry->parameters)};
  if (result.parameters.values().contains("scale")) result.parameters.set("scale", scale);
  return result;
}

inline const ElectronicsKey default_key{.seed = 11, .trial = 3, .device = 0, .sensor_name = "pad"};

// Returns the output of a chain for the constant sample `input` at each of `times`.
inline std::vector<std::vector<float>> outputs(const std::vector<Named>& parts, const SignalModel& model, float input,
                                               const std::vector<double>& times, const ElectronicsKey& key = default_key) {
  Electronics electronics(parts, model, key);
  std::vector<std::vector<float>> result;
  for (const double time : times) {
    std::vector<float> sample(model.source.size(), input);
    electronics.apply(sample, time);
    result.push_back(sample);
  }
  return result;
}

}  // namespace slipbench
