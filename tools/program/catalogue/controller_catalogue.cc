#include "tools/program/catalogue/controller_catalogue.h"

#include "sim/core/error.h"

namespace slipbench {

const std::vector<ControllerKind>& controller_catalogue() {
  using namespace controllers;
  static const std::vector<ControllerKind> kinds{
      constant_force(), force_pid(), force_ratio(), hold_preset(), plugin(), reorient(), step_on_slip(), stuck_fraction(),
  };
  return kinds;
}

std::vector<Entry> controller_entries() {
  std::vector<Entry> entries;
  for (const ControllerKind& kind : controller_catalogue()) entries.push_back(kind.about);
  return entries;
}

std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source) {
  for (const ControllerKind& kind : controller_catalogue()) {
    if (kind.about.name == controller.name) return kind.create(controller.parameters, source);
  }
  std::vector<std::string> names;
  for (const ControllerKind& kind : controller_catalogue()) names.push_back(kind.about.name);
  throw InputError("controller: unknown type " + quote(controller.name) + allowed_names(controller.name, names));
}

}  // namespace slipbench
