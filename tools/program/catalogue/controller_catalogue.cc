#include "tools/program/catalogue/controller_catalogue.h"

#include <optional>
#include <utility>

#include "sim/core/error.h"
#include "tools/program/catalogue/registry.h"

namespace slipbench {
namespace {

Registry<ControllerMaker>& registered_controllers() {
  static Registry<ControllerMaker> registry;
  return registry;
}

std::vector<Entry> own_entries() {
  std::vector<Entry> entries;
  for (const ControllerKind& kind : controller_catalogue()) entries.push_back(kind.about);
  return entries;
}

}  // namespace

const std::vector<ControllerKind>& controller_catalogue() {
  using namespace controllers;
  static const std::vector<ControllerKind> kinds{
      constant_force(), force_pid(), force_ratio(), hold_preset(), plugin(), reorient(), step_on_slip(), stuck_fraction(),
  };
  return kinds;
}

std::vector<Entry> controller_entries() {
  std::vector<Entry> entries = own_entries();
  for (const Entry& entry : registered_controllers().entries()) entries.push_back(entry);
  return entries;
}

void register_controller(const Entry& about, ControllerMaker make) {
  registered_controllers().put("controller", about, std::move(make), own_entries());
}

std::unique_ptr<Controller> make_controller(const Named& controller, const GripSource& source) {
  for (const ControllerKind& kind : controller_catalogue()) {
    if (kind.about.name == controller.name) return kind.create(controller.parameters, source);
  }
  if (const std::optional<ControllerMaker> make = registered_controllers().find(controller.name))
    return (*make)(controller.parameters, source);
  std::vector<std::string> names;
  for (const Entry& entry : controller_entries()) names.push_back(entry.name);
  throw InputError("controller: unknown type " + quote(controller.name) + allowed_names(controller.name, names));
}

}  // namespace slipbench
