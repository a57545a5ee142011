// Declarations of all controllers. Each is defined in the file of its name, except constant_force
// and hold_preset (preset_grip.cc).
#pragma once

#include <memory>
#include <vector>

#include "sim/api/controller.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Inputs for making a controller.
struct GripSource {
  std::vector<Channel> channels;        // content of the frames passed to update()
  double preset = 0.0;                  // N, force with which the box is taken: the scene's grip.preset
  bool detected = true;                 // the scene has a detector; otherwise every estimate is no contact
  std::vector<Feature> features{};      // features of the estimates passed to update(): Detector::features()
  bool guided = false;                  // the scene's motion accepts GripCommand::arm; otherwise no arm command is allowed
  std::vector<SensorSource> sensors{};  // all sensors of the scene, in order; update() receives frames of the first
};

// Tightenings of a controller that count as answers to a slip (GraspOutcome::reaction_time).
enum class Answers {
  by_own_rule,  // all: the controller reacts to slip by its own readings, or its rule is unknown
  seen_slip,    // those after an update in which the detector reported slip; the others keep the preset force
  nothing,      // none: the controller ignores slip
};

// A controller that a scene may name.
struct ControllerKind {
  Entry about;
  // `parameters`: all parameters that `about` declares. Throws SceneValueError at controller.<key>
  // for values that conflict with others, and at controller.type if the frames lack a channel that
  // the controller reads or the scene lacks a detector that it needs.
  std::unique_ptr<Controller> (*create)(const Parameters& parameters, const GripSource& source);
  Answers answers = Answers::by_own_rule;
  bool users_code = false;  // its code is not part of slipbench
};

namespace controllers {

template <class Made>
std::unique_ptr<Controller> created(const Parameters& parameters, const GripSource& source) {
  return std::make_unique<Made>(parameters, source);
}

ControllerKind constant_force();
ControllerKind force_ratio();
ControllerKind hold_preset();
ControllerKind plugin();
ControllerKind reorient();
ControllerKind step_on_slip();
ControllerKind timed_grip();

}  // namespace controllers
}  // namespace slipbench
