// Where the program's controllers are composed: the one place that names them all.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "controllers/controller_kinds.h"
#include "sim/core/parameters.h"

namespace slipbench {

// All of the program's own controllers that a scene may name as controller.type, beside none.
const std::vector<ControllerKind>& controller_catalogue();

// `parameters`: those of the controller's entry, all present.
using ControllerMaker = std::function<std::unique_ptr<Controller>(const Parameters& parameters, const GripSource& source)>;

// As register_detector().
void register_controller(const Entry& about, ControllerMaker make);

// The declarations of all: the program's own in the same order, then those that are registered.
std::vector<Entry> controller_entries();

// The controller `controller.name` with its parameters, for `source`. Throws InputError for a name that the catalogue does
// not have, and what the controller itself refuses.
std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source);

}  // namespace slipbench
