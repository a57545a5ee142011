// A trial's record for numpy: views of the record's memory, which lives as long as any view.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "python/arrays.h"
#include "python/module.h"
#include "sim/api/pad_state_names.h"
#include "tools/dataset/record/codes.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/files/output_file.h"
#include "tools/learning_data/label_rules.h"
#include "tools/learning_data/samples.h"
#include "tools/learning_data/vendor_states.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using RecordPointer = std::shared_ptr<TrialRecord>;
using Described = nb::typed<nb::dict, nb::str, nb::any>;  // attributes of a class of the package
using ByName = nb::typed<nb::dict, nb::str, Described>;

// View [rows, shape...] of `values`; None if the record lacks the column.
template <class T>
nb::object view(const RecordPointer& record, std::vector<T>& values, std::vector<std::size_t> shape = {}) {
  std::size_t row = 1;
  for (const std::size_t extent : shape) row *= extent;
  shape.insert(shape.begin(), row == 0 ? 0 : values.size() / row);
  const nb::capsule capsule(new RecordPointer(record), [](void* held) noexcept { delete static_cast<RecordPointer*>(held); });
  return nb::cast(nb::ndarray<nb::numpy, const T>(values.data(), shape.size(), shape.data(), capsule));
}

// Attribute of a class of the package for an array of a dataset: that of the events and of times has
// another name.
std::string attribute_name(std::string_view array) {
  if (array == "events/t") return "event_time";
  if (array == "arm_speed") return "arm";
  if (array.starts_with("events/")) return fmt::format("event_{}", array.substr(7));
  if (array.ends_with("_s")) array.remove_suffix(2);
  return std::string(array);
}

nb::dict labels_of(const RecordPointer& record, LabelRecord& labels) {
  nb::dict all;
  const auto add = [&](const char* name, const char*, const Extents& tail, auto& values) {
    all[attribute_name(name).c_str()] = view(record, values, tail);
  };
  for_each_label(labels, labels.units(), add);
  // Labels without truth have empty columns of the others.
  all["event_time"] = view(record, labels.event_time);
  all["event_unit"] = view(record, labels.event_unit);
  all["event_kind"] = view(record, labels.event_kind);
  for_each_unit_attribute(labels, add);
  return all;
}

// Unit of each array of the classes of the package, in the order of their attributes.
using Units = nb::typed<nb::dict, nb::str, nb::typed<nb::dict, nb::str, nb::str>>;
Units array_units() {
  nb::dict labels, body, control, contact;
  for (nb::dict* one : {&labels, &body, &control, &contact}) (*one)["t"] = "s";
  const auto into = [](nb::dict& units) {
    return [&units](const char* name, std::string_view unit, const Extents&, const auto&) {
      const std::string_view shown = shown_unit(name, unit);
      units[attribute_name(name).c_str()] = nb::str(shown.data(), shown.size());
    };
  };
  const LabelRecord label_record;
  for_each_label(label_record, 0, into(labels));
  for_each_event_column(label_record, into(labels));
  for_each_unit_attribute(label_record, into(labels));
  const BodyRecord body_record;
  for_each_body_column(body_record, into(body));
  const ControlRecord control_record;
  for_each_control_column(control_record, into(control));
  for_each_grip_column(control_record.grip, into(control));
  for_each_arm_column(control_record.grip, into(control));
  contact["force"] = "N";
  contact["displacement"] = "m";
  nb::dict all;
  all["Labels"] = labels;
  all["Contact"] = contact;
  all["Body"] = body;
  all["Control"] = control;
  return Units(all);
}

using Codes = nb::typed<nb::dict, nb::str, int>;
template <class Choices>
Codes codes_by_name(const Choices& choices) {
  nb::dict codes;
  for (const auto& choice : choices) codes[choice.name] = static_cast<int>(choice.value);
  return Codes(codes);
}

nb::dict sensor_of(const RecordPointer& record, SensorRecord& sensor) {
  nb::dict channels, units, times;
  for (SensorColumn& column : sensor.channels) {
    const nb::str name(column.name.c_str());
    channels[name] = view(record, column.values, column.shape);
    units[name] = column.unit;
    if (column.time) times[name] = view(record, *column.time);
  }
  nb::dict all;
  all["name"] = sensor.name;
  all["type"] = sensor.type;
  all["rate"] = sensor.rate;
  all["frame"] = sensor.frame;
  all["follows"] = sensor.follows;
  all["t"] = view(record, sensor.time);
  all["channels"] = channels;
  all["units"] = units;
  all["channel_time"] = times;
  all["labels"] = labels_of(record, sensor.labels);
  return all;
}

nb::typed<nb::object, std::optional<Described>> control_of(const RecordPointer& record) {
  if (!record->control) return nb::none();
  ControlRecord& control = *record->control;
  nb::dict all;
  all["detector"] = control.detector;
  all["controller"] = control.controller;
  all["sensor"] = control.sensor;
  all["rate"] = control.rate;
  all["t"] = view(record, control.time);
  all["detector_class"] = view(record, control.detector_class);
  all["command"] = view(record, control.grip.command, {3});
  all["measured_position"] = view(record, control.grip.measured_position);
  all["grip_force"] = view(record, control.grip.grip_force);
  all["arm"] = view(record, control.grip.arm, {2});
  return all;
}

ByName bodies_of(const RecordPointer& record) {
  ByName all;
  for (BodyRecord& body : record->bodies) {
    nb::dict one;
    one["t"] = view(record, record->body_time);
    one["pose"] = view(record, body.pose, {7});
    one["velocity"] = view(record, body.velocity, {6});
    all[nb::str(body.name.c_str())] = one;
  }
  return all;
}

std::string sha256_of(const TrialRecord& record) {
  nb::gil_scoped_release release;
  return hexadecimal(trial_digest(record));
}

template <class T>
using Rows = nb::ndarray<const T, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// vendor_states() of a PapillArray [T,9], and 1 where the centre pillar is loaded [T]. `unit_state`
// [T,9], `slip_velocity` [T,18], `force` [T,27]: arrays of its labels. `rule`: name of a rule for
// single pillars, with default_label_speed.
using VendorStates = nb::typed<nb::tuple, nb::ndarray<nb::numpy, std::int64_t>, nb::ndarray<nb::numpy, std::uint8_t>>;
VendorStates states_by_vendor(const Rows<std::uint8_t>& unit_state, const Rows<float>& slip_velocity, const Rows<float>& force,
                              const std::string& rule) {
  const PillarLabels labels({unit_state.data(), unit_state.size()}, {slip_velocity.data(), slip_velocity.size()},
                            {force.data(), force.size()}, parse_label_rule(rule, LabelUse::pillars), default_label_speed);
  std::vector<std::int64_t> states;
  for (const VendorState state : vendor_states(labels)) states.push_back(static_cast<std::int64_t>(state));
  std::vector<std::uint8_t> loaded;
  for (std::size_t row = 0; row < labels.size(); ++row) loaded.push_back(is_loaded(labels, row, middle_pillar) ? 1 : 0);
  return nb::make_tuple(array_of(std::move(states), {labels.size(), pillars}), array_of(std::move(loaded)));
}

}  // namespace

void bind_trial(nb::module_& module) {
  module.def("array_units", &array_units);
  module.def("pad_states", [] { return codes_by_name(pad_states); });
  module.def("event_kinds", [] { return codes_by_name(event_kinds); });
  module.attr("unknown_state") = static_cast<int>(unknown_state);
  module.attr("unknown_state_name") = unknown_state_name;
  module.attr("pillars") = pillars;
  module.attr("middle_pillar") = middle_pillar;
  module.attr("vendor_contact_force") = vendor_contact_force;
  module.attr("vendor_state_unknown") = static_cast<int>(VendorState::unknown);
  module.def("vendor_codes_text", &vendor_codes_text);
  module.def("vendor_states", &states_by_vendor, nb::arg("unit_state"), nb::arg("slip_velocity"), nb::arg("force"),
             nb::arg("rule"));
  nb::class_<TrialRecord>(module, "Record")
      .def_ro("trial", &TrialRecord::trial)
      .def_ro("seed", &TrialRecord::seed)
      .def_ro("params_json", &TrialRecord::params)
      .def_prop_ro("outcome_json", [](const TrialRecord& record) { return outcome_json(record.outcome); })
      .def("sha256", &sha256_of)
      .def_static("sensors",
                  [](const RecordPointer& record) {
                    ByName all;
                    for (SensorRecord& sensor : record->sensors) all[nb::str(sensor.name.c_str())] = sensor_of(record, sensor);
                    return all;
                  })
      .def_static("bodies", &bodies_of)
      .def_static("control", &control_of);
}

}  // namespace slipbench::python
