// A trial's record as numpy sees it: views of the record's own memory, which lives as long as any of them.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "tools/base/files/output_file.h"
#include "tools/base/record/encoder.h"
#include "tools/base/record/trial_record.h"
#include "tools/python/module.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using Held = std::shared_ptr<TrialRecord>;
using Described = nb::typed<nb::dict, nb::str, nb::any>;  // what a class of the package is made of, by its attributes
using ByName = nb::typed<nb::dict, nb::str, Described>;

// [rows, shape...] of `values`; nothing where the record has no such column.
template <class T>
nb::object view(const Held& record, std::vector<T>& values, std::vector<std::size_t> shape = {}) {
  std::size_t row = 1;
  for (const std::size_t extent : shape) row *= extent;
  shape.insert(shape.begin(), row == 0 ? 0 : values.size() / row);
  const nb::capsule capsule(new Held(record), [](void* held) noexcept { delete static_cast<Held*>(held); });
  return nb::cast(nb::ndarray<nb::numpy, const T>(values.data(), shape.size(), shape.data(), capsule));
}

nb::dict labels_of(const Held& record, LabelRecord& labels) {
  const std::size_t units = labels.units();
  nb::dict all;
  all["unit_state"] = view(record, labels.unit_state, {units});
  all["slip_velocity"] = view(record, labels.slip_velocity, {units, 2});
  all["slip_distance"] = view(record, labels.slip_distance, {units});
  all["margin"] = view(record, labels.margin, {units});
  all["force"] = view(record, labels.force, {units, 3});
  all["state"] = view(record, labels.state);
  all["state_micro"] = view(record, labels.state_micro);
  all["state_paper"] = view(record, labels.state_paper);
  all["stuck_fraction"] = view(record, labels.stuck_fraction);
  all["slip_direction"] = view(record, labels.slip_direction);
  all["slip_centre"] = view(record, labels.slip_centre, {2});
  all["slip_angle"] = view(record, labels.slip_angle);
  all["event_time"] = view(record, labels.event_time);
  all["event_unit"] = view(record, labels.event_unit);
  all["event_kind"] = view(record, labels.event_kind);
  all["unit_positions"] = view(record, labels.unit_positions, {2});
  all["unit_heights"] = view(record, labels.unit_heights);
  all["k_normal"] = view(record, labels.k_normal);
  all["k_tangential"] = view(record, labels.k_tangential);
  all["mu_static"] = view(record, labels.mu_static);
  all["mu_kinetic"] = view(record, labels.mu_kinetic);
  all["onset_time"] = view(record, labels.onset_time);
  all["micro_onset_time"] = view(record, labels.micro_onset_time);
  return all;
}

nb::dict sensor_of(const Held& record, SensorRecord& sensor) {
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
  all["time"] = view(record, sensor.time);
  all["channels"] = channels;
  all["units"] = units;
  all["channel_time"] = times;
  all["labels"] = labels_of(record, sensor.labels);
  return all;
}

nb::typed<nb::object, std::optional<Described>> control_of(const Held& record) {
  if (!record->control) return nb::none();
  ControlRecord& control = *record->control;
  nb::dict all;
  all["detector"] = control.detector;
  all["controller"] = control.controller;
  all["sensor"] = control.sensor;
  all["rate"] = control.rate;
  all["time"] = view(record, control.time);
  all["detector_class"] = view(record, control.detector_class);
  all["command"] = view(record, control.grip.command, {3});
  all["measured_position"] = view(record, control.grip.measured_position);
  all["grip_force"] = view(record, control.grip.grip_force);
  all["arm"] = view(record, control.grip.arm, {2});
  return all;
}

ByName bodies_of(const Held& record) {
  ByName all;
  for (BodyRecord& body : record->bodies) {
    nb::dict one;
    one["time"] = view(record, record->body_time);
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

}  // namespace

void bind_trial(nb::module_& module) {
  nb::class_<TrialRecord>(module, "Record")
      .def_ro("trial", &TrialRecord::trial)
      .def_ro("seed", &TrialRecord::seed)
      .def_ro("params_json", &TrialRecord::params)
      .def_prop_ro("outcome_json", [](const TrialRecord& record) { return outcome_json(record.outcome); })
      .def("sha256", &sha256_of)
      .def_static("sensors",
                  [](const Held& record) {
                    ByName all;
                    for (SensorRecord& sensor : record->sensors) all[nb::str(sensor.name.c_str())] = sensor_of(record, sensor);
                    return all;
                  })
      .def_static("bodies", &bodies_of)
      .def_static("control", &control_of);
}

}  // namespace slipbench::python
