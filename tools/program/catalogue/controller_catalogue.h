// Where the program's controllers are composed: the one place that names them all.
#pragma once

#include <memory>
#include <vector>

#include "controllers/controller_kinds.h"
#include "sim/core/parameters.h"

namespace slipbench {

// All controllers that a scene may name as controller.type, beside none.
const std::vector<ControllerKind>& controller_catalogue();

// Their declarations, in the same order.
std::vector<Entry> controller_entries();

// The controller `controller.name` with its parameters, for `source`. Throws InputError for a name that the catalogue does
// not have, and what the controller itself refuses.
std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source);

}  // namespace slipbench
