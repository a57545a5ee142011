// A trial's record for numpy: views of the record's memory, which lives as long as any view.
#include <memory>
#include <optional>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "python/module.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/files/output_file.h"

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

// Columns by their names in a dataset, except for the events and the unit suffix of times.
nb::dict labels_of(const RecordPointer& record, LabelRecord& labels) {
  nb::dict all;
  for_each_label(labels, labels.units(), [&](const char* name, const char*, const Extents& tail, auto& values) {
    all[name] = view(record, values, tail);
  });
  all["event_time"] = view(record, labels.event_time);
  all["event_unit"] = view(record, labels.event_unit);
  all["event_kind"] = view(record, labels.event_kind);
  for_each_unit_attribute(labels, [&](std::string name, const Extents& tail, std::vector<double>& values) {
    if (name.ends_with("_s")) name.resize(name.size() - 2);
    all[name.c_str()] = view(record, values, tail);
  });
  return all;
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

}  // namespace

void bind_trial(nb::module_& module) {
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
