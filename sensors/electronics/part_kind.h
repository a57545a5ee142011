// Catalogue entries of the electronics' parts, one function per part. drawn_once.cc defines those
// drawn once; the others have files of their own.
#pragma once

#include <memory>
#include <string>
#include <type_traits>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/random.h"

namespace slipbench {

// Scope of a part's random numbers.
enum class DrawnPer { trial, device, never };

struct PartKind {
  Entry entry;
  DrawnPer drawn_per;
  // `stream` is used by this part alone.
  std::unique_ptr<ElectronicsStage> (*make)(const Parameters& parameters, const SignalModel& model, RandomStream stream);
  // Throws SceneValueError for parameters that conflict with each other or with the sensor. Null:
  // all values in range are valid. `path`: of the part in the scene.
  void (*check)(const Parameters& parameters, const SignalModel& model, const std::string& path) = nullptr;
};

// Makes a stage from the parameters and the model, and from the stream if the stage draws.
template <class Stage>
std::unique_ptr<ElectronicsStage> made(const Parameters& parameters, const SignalModel& model, RandomStream stream) {
  if constexpr (std::is_constructible_v<Stage, const Parameters&, const SignalModel&, RandomStream>) {
    return std::make_unique<Stage>(parameters, model, stream);
  } else {
    return std::make_unique<Stage>(parameters, model);
  }
}

PartKind low_pass_part();
PartKind scan_part();
std::vector<PartKind> drawn_once_parts();  // coupling, gain, offset, drift
PartKind noise_part();
PartKind white_noise_part();
PartKind skewed_noise_part();
PartKind quantisation_part();
PartKind valid_range_part();

// The parameter that every random part has: a factor on the device's own figure.
ParameterSpec scale_parameter();

}  // namespace slipbench
