// SensorKind of one bundled sensor. This file is compiled into the library of each one
// (slipbench_bundled_sensor in cmake/SlipbenchLibrary.cmake), which defines its name and renames
// its exported symbols, so that several sensors fit into one program.
#include <utility>

#include "sensors/plugins/plugin_sensor.h"
#include "sim/api/sensor_kind.h"

namespace slipbench {
namespace {

constexpr BundledSensor bundled{SLIPBENCH_BUNDLED_TYPE, slipbench_sensor_parameters, &slipbench_sensor_about,
                                &slipbench_make_sensor};

}  // namespace

SensorKind SLIPBENCH_BUNDLED_KIND();

SensorKind SLIPBENCH_BUNDLED_KIND() {
  const slipbench_about& about = *bundled.about;
  SensorView view;
  for (const slipbench_unit* one = about.units; one != nullptr && one->channel != nullptr; ++one)
    view.channels.push_back({.channel = one->channel, .name = one->channel, .unit = one->unit});
  return {.about = {bundled.type, about.summary, about.law, about.source, specs_of(bundled)},
          .electronics = {},
          .create = [](const Parameters& parameters, const std::vector<Named>&, std::uint64_t seed, std::uint64_t trial,
                       const std::string& name) { return make_bundled(bundled, parameters, seed, trial, name); },
          .view = std::move(view)};
}

}  // namespace slipbench
