// Every controller's declaration; each is defined in the file of its name.
#pragma once

#include <memory>
#include <vector>

#include "sim/core/controller.h"
#include "sim/core/parameters.h"

namespace slipbench {

// A controller that a scene may name.
struct ControllerKind {
  Entry about;
  // `parameters`: those of `about`, all present. `channels`: what the frames hold that update() will be handed. Throws SceneValueError
  // at controller.<key> for a value that does not fit the rest, and at controller.type where the frames lack what the controller reads.
  std::unique_ptr<Controller> (*create)(const Parameters& parameters, const std::vector<Channel>& channels);
};

namespace controllers {

ControllerKind constant_force();
ControllerKind force_pid();
ControllerKind force_ratio();
ControllerKind hold_preset();
ControllerKind plugin();
ControllerKind step_on_slip();
ControllerKind stuck_fraction();

}  // namespace controllers
}  // namespace slipbench
