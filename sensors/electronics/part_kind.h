// The catalogue's view of a part of the electronics. One function a part, each defined in the part's own file.
#pragma once

#include <memory>
#include <string>

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

PartKind scan_part();
PartKind coupling_part();
PartKind gain_part();
PartKind offset_part();
PartKind drift_part();
PartKind noise_part();
PartKind white_noise_part();
PartKind skewed_noise_part();
PartKind quantisation_part();

// The parameter that every part with a random disturbance has: a factor on the device's own figure.
ParameterSpec scale_parameter();

}  // namespace slipbench
