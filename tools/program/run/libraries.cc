#include "tools/program/run/libraries.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench {
namespace {

bool has_effect(const Scene& scene, std::string_view name) {
  return std::ranges::find(scene.effects, name, &Named::name) != scene.effects.end();
}

// Whether a sensor, detector or controller of this type is a plugin's, or that of a program that embeds this one.
bool is_users(const std::string& type, const std::vector<Entry>& own) {
  return !type.empty() && (type == "plugin" || std::ranges::find(own, type, &Entry::name) == own.end());
}

}  // namespace

std::string libraries_of(const Scene& scene) {
  const std::string detector = scene.detector ? scene.detector->type : "",
                    controller = scene.controller ? scene.controller->name : "";
  const bool spectral = detector == "band_energy" || detector == "nib_linear_slip" || detector == "nib_slip_kind";
  std::vector<std::string_view> libraries;
  if (scene.dynamic() || scene.fidelity != "field") libraries.emplace_back("MuJoCo");
  if (has_effect(scene, "elastic_skin") || spectral || detector == "network") libraries.emplace_back("FFTW");
  if (detector == "network") libraries.emplace_back("network");
  static const Catalogues own = command_line_catalogues();
  const bool users_sensor =
      std::ranges::any_of(scene.sensors, [](const SensorScene& sensor) { return is_users(sensor.type, own.sensors); });
  if (users_sensor || is_users(detector, own.detectors) || is_users(controller, own.controllers))
    libraries.emplace_back("user's library");
  return fmt::format("{}", fmt::join(libraries, ", "));
}

}  // namespace slipbench
