#include "tools/trial/libraries.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

bool has_effect(const Scene& scene, std::string_view name) {
  return std::ranges::find(scene.effects, name, &Named::name) != scene.effects.end();
}

// True if an embedding application registered a type.
bool is_registered_sensor(const SensorScene& sensor) {
  const std::vector<Entry> registered = registered_sensor_entries();
  return std::ranges::find(registered, sensor.type, &Entry::name) != registered.end();
}
bool is_registered(const std::string& type, std::vector<Entry> Catalogues::*own) {
  if (type.empty() || type == "plugin") return false;
  static const Catalogues catalogues =
      command_line_catalogues();  // created on demand: it costs as much as the set-up of a short trial
  return std::ranges::find(catalogues.*own, type, &Entry::name) == (catalogues.*own).end();
}

// True if a type belongs to a plugin or to an embedding application.
bool is_users_sensor(const SensorScene& sensor) { return sensor.type == "plugin" || is_registered_sensor(sensor); }
bool is_users(const std::string& type, std::vector<Entry> Catalogues::*own) {
  return type == "plugin" || is_registered(type, own);
}

std::string detector_of(const Scene& scene) { return scene.detector ? scene.detector->type : ""; }
std::string controller_of(const Scene& scene) { return scene.controller ? scene.controller->name : ""; }

}  // namespace

bool has_registered_parts(const Scene& scene) {
  return std::ranges::any_of(scene.sensors, is_registered_sensor) || is_registered(detector_of(scene), &Catalogues::detectors) ||
         is_registered(controller_of(scene), &Catalogues::controllers);
}

std::string libraries_of(const Scene& scene) {
  const std::string detector = detector_of(scene), controller = controller_of(scene);
  const bool spectral = detector == "band_energy" || detector == "nib_linear_slip" || detector == "nib_slip_kind";
  std::vector<std::string_view> libraries;
  if (scene.dynamic() || scene.fidelity != "field") libraries.emplace_back("MuJoCo");
  if (has_effect(scene, "elastic_skin") || spectral || detector == "network") libraries.emplace_back("FFTW");
  if (detector == "network") libraries.emplace_back("network");
  if (std::ranges::any_of(scene.sensors, is_users_sensor) || is_users(detector, &Catalogues::detectors) ||
      is_users(controller, &Catalogues::controllers))
    libraries.emplace_back("user's library");
  return fmt::format("{}", fmt::join(libraries, ", "));
}

}  // namespace slipbench
