#include "sensors/plugins/plugin_sensor.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "sensors/plugins/own_sensor.h"
#include "sim/api/sensor_kind.h"
#include "sim/core/error.h"
#include "sim/plugins/plugin_library.h"

namespace slipbench {
namespace {

// Copies the layout that the library points to. Counts beyond a limit are cut to one above it, so
// that set() refuses them.
OwnLayout layout_of(const slipbench_readout& readout) {
  OwnLayout layout{.rate = readout.rate, .elements = {}, .units = {}, .channels = {}};
  for (std::size_t i = 0; i < std::min(readout.element_count, OwnLayout::most_elements + 1); ++i) {
    const slipbench_element& from = readout.elements[i];
    layout.elements.push_back({.tip = Eigen::Vector3d(from.tip),
                               .axis = Eigen::Vector3d(from.direction),
                               .k_normal = from.k_normal,
                               .k_tangential = from.k_tangential});
    layout.units.push_back(from.unit);
  }
  for (std::size_t i = 0; i < std::min(readout.channel_count, OwnLayout::most_channels + 1); ++i) {
    const slipbench_channel& from = readout.channels[i];
    const std::size_t dimensions = std::min(from.dimensions, OwnLayout::most_dimensions + 1);
    layout.channels.push_back({from.name, from.unit, {from.shape, from.shape + dimensions}, {}});
  }
  return layout;
}

// The parameters that the source declares, with the values from `parameters`, which must outlive
// the result.
std::vector<slipbench_parameter> values_of(const BundledSensor& bundled, const Parameters& parameters) {
  std::vector<slipbench_parameter> values;
  for (const slipbench_parameter* row = bundled.parameters; *row->name != '\0'; ++row) {
    slipbench_parameter& value = values.emplace_back(*row);
    switch (row->type) {
      case SLIPBENCH_NUMBER: value.number = parameters.number(row->name); break;
      case SLIPBENCH_BOOLEAN: value.number = parameters.flag(row->name) ? 1.0 : 0.0; break;
      default: value.text = parameters.choice(row->name).c_str();
    }
  }
  return values;
}

ParameterSpec spec_of(const slipbench_parameter& row, const slipbench_note& note) {
  if (row.type == SLIPBENCH_BOOLEAN) return flag_spec(row.name, row.number != 0.0 ? "true" : "false", note.doc, note.source);
  if (row.type == SLIPBENCH_NUMBER) {
    const Quantity quantity = *row.unit == '\0' ? Quantity::none : quantity_of(std::string("1 ") + row.unit);
    const Range range = note.least == 0.0 && note.most == 0.0 ? any_value : Range{note.least, note.most};
    return number_spec(row.name, quantity, format_quantity(row.number, quantity), range, note.doc, note.source);
  }
  std::vector<std::string> choices;
  std::istringstream text(note.choices);
  for (std::string choice; std::getline(text, choice, '|');) choices.push_back(choice);
  return choice_spec(row.name, row.text, choices, note.doc, note.source);
}

class PluginSensor final : public OwnSensor {
 public:
  // `bundled`: null where the scene names a library.
  PluginSensor(const BundledSensor* bundled, const Parameters& parameters, std::uint64_t seed, std::uint64_t trial,
               const std::string& name)
      : OwnSensor("sensors." + name + (bundled != nullptr ? ".type" : ".library"),
                  "'" + (bundled != nullptr ? bundled->type : parameters.path("library")) + "'"),
        made_(bundled != nullptr ? Made("sensor", bundled->type, "sensors." + name)
                                 : Made("sensor", parameters, SLIPBENCH_SENSOR_BUILD, "sensors." + name)),
        trusted_(bundled != nullptr) {
    made_.object.name = name.c_str();
    made_.object.seed = seed;
    made_.object.trial = trial;
    if (bundled != nullptr) {
      made_.make(bundled->make, values_of(*bundled, parameters), {}, 0, &slipbench_readout::measure);
    } else {
      made_.make<decltype(slipbench_make_sensor)>(parameters, {}, 0, &slipbench_readout::measure);
    }
    OwnLayout layout;
    made_.library.call("slipbench_make_sensor", [&] { layout = layout_of(made_.object); });
    set(std::move(layout));
  }

  void finish() override { made_.finish(); }

 private:
  using Made = PluginObject<slipbench_readout>;

  void read(const ContactFrame& frame, std::span<float> values) override {
    // A library gets a copy because it may cast `const` away, and the labels are computed from the
    // same arrays.
    const ContactFrame& truth = trusted_ ? frame : (copy_ = frame);
    const slipbench_contact contact{.time = truth.time,
                                    .force = truth.force.data(),
                                    .displacement = truth.displacement.data(),
                                    .depth = truth.element_depth.data(),
                                    .shear = truth.element_shear.data(),
                                    .units = layout().units.size(),
                                    .elements = layout().elements.size()};
    made_.library.call("measure", [&] { made_.object.measure(made_.object.self, &contact, values.data()); });
  }

  Made made_;
  bool trusted_;  // built into the program
  ContactFrame copy_;
};

}  // namespace

std::vector<ParameterSpec> specs_of(const BundledSensor& bundled) {
  std::vector<ParameterSpec> specs;
  for (std::size_t i = 0; *bundled.parameters[i].name != '\0'; ++i)
    specs.push_back(spec_of(bundled.parameters[i], bundled.about->notes[i]));
  return specs;
}

std::unique_ptr<Sensor> make_bundled(const BundledSensor& bundled, const Parameters& parameters, std::uint64_t seed,
                                     std::uint64_t trial, const std::string& name) {
  return std::make_unique<PluginSensor>(&bundled, parameters, seed, trial, name);
}

SensorKind plugin_sensor() {
  return {
      .about =
          {"plugin", "A custom sensor from a shared library.",
           "The library defines the positions of its elements and computes each sample from their contact. It exports slipbench_sensor_abi and slipbench_make_sensor (sensors/plugin_abi.h; example: sensors/example).",
           "the library's author", plugin_specs()},
      .electronics = {},
      .create = [](const Parameters& parameters, const std::vector<Named>&, std::uint64_t seed, std::uint64_t trial,
                   const std::string& name) -> std::unique_ptr<Sensor> {
        return std::make_unique<PluginSensor>(nullptr, parameters, seed, trial, name);
      },
      .users_code = true};
}

}  // namespace slipbench
