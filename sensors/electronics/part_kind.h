// The catalogue's view of a part of the electronics. One function a part: those drawn once are defined in drawn_once.cc, the others in files of their own.
#pragma once

#include <memory>
#include <string>
#include <type_traits>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/random.h"

namespace slipbench {

// What a part's random numbers belong to.
enum class DrawnPer { trial, device, never };

struct PartKind {
  Entry entry;
  DrawnPer drawn_per;
  // `stream` is the part's own.
  std::unique_ptr<ElectronicsStage> (*make)(const Parameters& parameters, const SignalModel& model, RandomStream stream);
  // Throws SceneValueError for parameters that do not go together or with the sensor; null: all that are in their ranges do. `path`: of the part
  // in the scene.
  void (*check)(const Parameters& parameters, const SignalModel& model, const std::string& path) = nullptr;
};

// What makes a stage out of the parameters and the model, and out of the stream where it draws.
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

// The parameter that every part with a random disturbance has: a factor on the device's own figure.
ParameterSpec scale_parameter();

}  // namespace slipbench
