#include <algorithm>
#include <memory>
#include <utility>

#include "sensors/own/own_sensor.h"
#include "sensors/plugin_abi.h"
#include "sim/core/error.h"
#include "sim/core/process/plugin_library.h"
#include "sim/core/sensor_kind.h"

namespace slipbench {
namespace {

// What the library's pointers lead to, which may be nowhere: to be called guarded. Of more than is allowed so much that set() refuses it.
OwnLayout layout_of(const slipbench_readout& readout) {
  OwnLayout said{.rate = readout.rate, .elements = {}, .units = {}, .channels = {}};
  for (std::size_t i = 0; i < std::min(readout.element_count, OwnLayout::most_elements + 1); ++i) {
    const slipbench_element& from = readout.elements[i];
    said.elements.push_back({.tip = Eigen::Vector3d(from.tip),
                             .axis = Eigen::Vector3d(from.direction),
                             .k_normal = from.k_normal,
                             .k_tangential = from.k_tangential});
    said.units.push_back(from.unit);
  }
  for (std::size_t i = 0; i < std::min(readout.channel_count, OwnLayout::most_channels + 1); ++i) {
    const slipbench_channel& from = readout.channels[i];
    const std::size_t dimensions = std::min(from.dimensions, OwnLayout::most_dimensions + 1);
    said.channels.push_back({from.name, from.unit, {from.shape, from.shape + dimensions}, {}});
  }
  return said;
}

class PluginSensor final : public OwnSensor {
 public:
  PluginSensor(const Parameters& parameters, std::uint64_t seed, std::uint64_t trial, const std::string& name)
      : OwnSensor("sensors." + name + ".library", "'" + parameters.path("library") + "'"),
        made_("sensor", parameters, SLIPBENCH_SENSOR_BUILD, "sensors." + name) {
    made_.object.name = name.c_str();
    made_.object.seed = seed;
    made_.object.trial = trial;
    made_.make<decltype(slipbench_make_sensor)>(parameters, {}, 0, &slipbench_readout::measure);
    OwnLayout said;
    made_.library.guarded("slipbench_make_sensor", [&] { said = layout_of(made_.object); });
    set(std::move(said));
  }

  void finish() override { made_.finish(); }

 private:
  void read(const ContactFrame& truth, std::span<float> values) override {
    const slipbench_contact contact{.time = truth.time,
                                    .force = truth.force.data(),
                                    .displacement = truth.displacement.data(),
                                    .depth = truth.element_depth.data(),
                                    .shear = truth.element_shear.data(),
                                    .units = layout().units.size(),
                                    .elements = layout().elements.size()};
    made_.library.guarded("measure", [&] { made_.object.measure(made_.object.self, &contact, values.data()); });
  }

  PluginObject<slipbench_readout> made_;
};

}  // namespace

SensorKind plugin_sensor() {
  return {
      .about =
          {"plugin", "Your own sensor, from a shared library.",
           "The library says where its elements stand and computes each sample from their contact. It exports slipbench_sensor_abi and slipbench_make_sensor (sensors/plugin_abi.h; example: sensors/example).",
           "the library's author", plugin_specs()},
      .electronics = {},
      .create = [](const Parameters& parameters, const std::vector<Named>&, std::uint64_t seed, std::uint64_t trial,
                   const std::string& name) -> std::unique_ptr<Sensor> {
        return std::make_unique<PluginSensor>(parameters, seed, trial, name);
      }};
}

}  // namespace slipbench
