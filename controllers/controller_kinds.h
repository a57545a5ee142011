// Every controller's declaration; each is defined in the file of its name, but for constant_force and hold_preset: preset_grip.cc.
#pragma once

#include <memory>
#include <vector>

#include "sim/core/controller.h"
#include "sim/core/parameters.h"

namespace slipbench {

// What a controller works with.
struct GripSource {
  std::vector<Channel> channels;    // what the frames hold that update() will be handed
  double preset = 0.0;              // N, the force with which the box is taken: the scene's grip.preset
  bool detected = true;             // the scene has a detector; without one every estimate is that of no contact
  std::vector<Feature> features{};  // what the estimates hold that update() will be handed: Detector::features()
  bool guided = false;              // the scene's motion takes GripCommand::arm; elsewhere a controller must command none
  std::vector<SensorSource>
      sensors{};  // all of the scene in its order; the first is the one whose frames update() will be handed
};

// Which of a controller's tightenings answer a slip (GraspOutcome::reaction_time).
enum class Answers {
  by_own_rule,  // each: it closes by what it reads of the slip, or nothing is known of its rule
  seen_slip,    // those that follow from an update to which the detector said slip; the others keep the preset force
  nothing,      // none: slip is ignored
};

// A controller that a scene may name.
struct ControllerKind {
  Entry about;
  // `parameters`: those of `about`, all present. Throws SceneValueError at controller.<key> for a value that does not fit the
  // rest, and at controller.type where the frames lack what the controller reads, or the scene the detector.
  std::unique_ptr<Controller> (*create)(const Parameters& parameters, const GripSource& source);
  Answers answers = Answers::by_own_rule;
};

namespace controllers {

template <class Made>
std::unique_ptr<Controller> created(const Parameters& parameters, const GripSource& source) {
  return std::make_unique<Made>(parameters, source);
}

ControllerKind constant_force();
ControllerKind force_pid();
ControllerKind force_ratio();
ControllerKind hold_preset();
ControllerKind plugin();
ControllerKind reorient();
ControllerKind step_on_slip();
ControllerKind stuck_fraction();
ControllerKind timed_grip();

}  // namespace controllers
}  // namespace slipbench
