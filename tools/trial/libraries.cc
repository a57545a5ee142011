#include "tools/trial/libraries.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "detectors/detector_kinds.h"
#include "sim/effects/install.h"
#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

// True if an embedding application registered the type.
bool is_registered(const SensorScene& sensor) {
  const std::vector<Entry> registered = registered_sensor_entries();
  return std::ranges::find(registered, sensor.type, &Entry::name) != registered.end();
}
bool is_registered(const DetectorScene& detector) { return detector_kind(detector.type) == nullptr; }
bool is_registered(const Named& controller) { return controller_kind(controller.name) == nullptr; }

}  // namespace

bool has_registered_parts(const Scene& scene) {
  return std::ranges::any_of(scene.sensors, [](const SensorScene& sensor) { return is_registered(sensor); }) ||
         (scene.detector && is_registered(*scene.detector)) || (scene.controller && is_registered(*scene.controller));
}

std::string libraries_of(const Scene& scene) {
  std::vector<std::string> libraries;
  const auto add = [&libraries](const std::vector<std::string>& more) {
    for (const std::string& one : more) {
      if (std::ranges::find(libraries, one) == libraries.end()) libraries.push_back(one);
    }
  };
  bool users_code = false;
  if (scene.dynamic() || scene.fidelity != "field") add({"MuJoCo"});
  for (const Named& effect : scene.effects) add(effect_kind(effect.name).libraries);
  for (const SensorScene& sensor : scene.sensors) {
    const SensorKind kind = sensor_kind(sensor.type);
    add(kind.libraries);
    users_code = users_code || kind.users_code;
  }
  if (scene.detector) {
    const DetectorKind* const kind = detector_kind(scene.detector->type);
    if (kind != nullptr) add(kind->libraries);
    users_code = users_code || kind == nullptr || kind->users_code;
  }
  if (scene.controller) {
    const ControllerKind* const kind = controller_kind(scene.controller->name);
    users_code = users_code || kind == nullptr || kind->users_code;
  }
  if (users_code) add({"user's library"});
  return fmt::format("{}", fmt::join(libraries, ", "));
}

}  // namespace slipbench
