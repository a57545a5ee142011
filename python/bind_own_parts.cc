// Sensors, detectors and controllers in Python. Trials run in threads without Python's lock, which
// each call acquires.
#include <algorithm>
#include <array>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <tuple>

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "python/module.h"
#include "sensors/plugins/own_sensor.h"
#include "sim/core/error.h"
#include "sim/plugins/plugin_library.h"
#include "tools/registry/program_catalogues.h"
#include "tools/registry/sensor_catalogue.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using Declared = std::vector<std::pair<std::string, std::string>>;  // parameters with their defaults, "5 mm"

// Values of a frame as numpy arrays by channel; each frame overwrites them.
template <class Real>
class FrameArrays {
 public:
  explicit FrameArrays(const std::vector<Channel>& channels) {
    std::size_t size = 0;
    for (const Channel& channel : channels) size += channel.size();
    auto* const values = new std::vector<Real>(size);
    values_ = values->data();
    const nb::capsule owner(values, [](void* held) noexcept { delete static_cast<std::vector<Real>*>(held); });
    Real* first = values_;
    for (const Channel& channel : channels) {
      arrays_[nb::str(channel.name.c_str())] =
          nb::cast(nb::ndarray<nb::numpy, const Real>(first, channel.shape.size(), channel.shape.data(), owner));
      first += channel.size();
    }
  }
  // `parts`: values of the channels, concatenated.
  const nb::dict& filled(std::initializer_list<std::span<const Real>> parts) {
    Real* at = values_;
    for (const std::span<const Real> part : parts) at = std::ranges::copy(part, at).out;
    return arrays_;
  }

 private:
  Real* values_;  // owned by the arrays
  nb::dict arrays_;
};

// Subject of an error message.
struct ErrorSubject {
  std::string path;         // path of the type in the scene: "detector.type"
  std::string name;         // "detector mine"
  std::string method = {};  // called method: "update"
};

// One instance of a user's Python class, for one trial. Created, used and released with Python's
// lock held. `Real`: type of its frames' values.
template <class Real>
struct Own {
  Own(const ErrorSubject& subject, const nb::object& type, const char* method, const nb::object& source, const nb::dict& keywords,
      const std::vector<Channel>& channels)
      : subject{subject.path, subject.name, method},
        package(nb::module_::import_("slipbench._own")),
        frame_type(package.attr("Frame")),
        made(type(source, **keywords)),
        call(made.attr(method)) {
    if (!channels.empty()) arrays.emplace(channels);
  }

  nb::object frame(double time, std::initializer_list<std::span<const Real>> parts) {
    return frame_type(time, arrays->filled(parts));
  }

  ErrorSubject subject;
  nb::object package, frame_type, made, call, shapes;
  std::optional<FrameArrays<Real>> arrays;
};
struct WithLock {
  template <class Real>
  void operator()(Own<Real>* own) const {
    if (!Py_IsInitialized()) return;  // the interpreter and its objects are gone
    const nb::gil_scoped_acquire acquire;
    delete own;
    // Flushes stdout, whose buffer would be lost if the process is killed.
    PyObject* const out = PySys_GetObject("stdout");
    const nb::object flushed = nb::steal(out == nullptr ? nullptr : PyObject_CallMethod(out, "flush", nullptr));
    if (!flushed) PyErr_Clear();
  }
};
template <class Real>
using OwnPart = std::unique_ptr<Own<Real>, WithLock>;

// Text of a Python exception. It may hold lone surrogates, which are invalid UTF-8 and break
// nanobind's what().
std::string text_of(const nb::python_error& error) {
  const nb::object lines = nb::module_::import_("traceback").attr("format_exception")(error.value());
  const nb::object text = nb::str("").attr("join")(lines).attr("strip")();
  return nb::cast<nb::bytes>(text.attr("encode")("utf-8", "backslashreplace")).c_str();
}

// Runs `work` with Python's lock; exceptions of the class become errors of the scene that names it.
template <class Work>
auto locked(const ErrorSubject& subject, Work&& work) {
  const nb::gil_scoped_acquire acquire;
  try {
    return work();
  } catch (const nb::python_error& error) {
    throw SceneValueError(subject.path, subject.name + ": " + text_of(error));
  } catch (const nb::cast_error&) {
    throw SceneValueError(subject.path, subject.name + ": returned a value of the wrong type");
  }
}

nb::dict keywords_of(const Parameters& parameters, const Declared& declared) {
  nb::dict all;
  for (const auto& [name, value] : declared) all[nb::str(name.c_str())] = parameters.number(name);
  return all;
}

nb::dict shapes_of(const std::vector<Channel>& channels) {
  nb::dict shapes;
  for (const Channel& channel : channels) {
    nb::list shape;
    for (const std::size_t extent : channel.shape) shape.append(extent);
    shapes[nb::str(channel.name.c_str())] = nb::tuple(shape);
  }
  return shapes;
}

Entry entry_of(const std::string& name, const std::string& summary, const Declared& declared) {
  Entry entry{.name = name, .summary = summary, .law = {}, .source = "a Python class", .parameters = {}};
  for (const auto& [parameter, value] : declared)
    entry.parameters.push_back(
        number_spec(parameter, quantity_of(value), value, any_value, "Parameter of the Python class.", "the class"));
  return entry;
}

class PythonDetector final : public Detector {
 public:
  explicit PythonDetector(OwnPart<float> own) : own_(std::move(own)) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    locked(own_->subject, [&] { read(own_->call(own_->frame(frame.time, {frame.values}))); });
    estimate_.time = frame.time;
    return estimate_;
  }

 private:
  void read(const nb::object& returned) {
    const nb::object estimate = own_->package.attr("estimate_of")(returned);
    estimate_.state = static_cast<PadState>(nb::cast<int>(nb::int_(estimate.attr("state"))));
    estimate_.latency = nb::cast<double>(estimate.attr("latency"));
    estimate_.stuck_fraction = nb::cast<double>(estimate.attr("stuck_fraction"));
  }

  OwnPart<float> own_;
  SlipEstimate estimate_;
};

class PythonController final : public Controller {
 public:
  explicit PythonController(OwnPart<float> own) : own_(std::move(own)) {}

  GripCommand update(const ControlInput& input) override {
    locked(own_->subject, [&] {
      const nb::object slip = own_->package.attr("Slip")(static_cast<int>(input.slip.state), input.slip.stuck_fraction,
                                                         input.gripper.position, input.gripper.moving, input.gripper.stopped);
      const nb::object command =
          own_->package.attr("command_of")(own_->call(own_->frame(input.frame.time, {input.frame.values}), slip));
      command_.position = nb::cast<int>(command.attr("position"));
      command_.speed = nb::cast<int>(command.attr("speed"));
      command_.force = nb::cast<int>(command.attr("force"));
    });
    return command_;
  }

 private:
  OwnPart<float> own_;
  GripCommand command_;
};

// A class receives the part of the truth that slipbench_contact has (sensors/plugin_abi.h).
class PythonSensor final : public OwnSensor {
 public:
  explicit PythonSensor(OwnPart<double> own) : OwnSensor(own->subject.path, own->subject.name), own_(std::move(own)) {
    locked(own_->subject, [&] {
      const auto returned = nb::cast<LayoutValues>(own_->package.attr("layout_of")(own_->made.attr("layout")()));
      OwnLayout layout{.rate = std::get<0>(returned), .elements = {}, .units = std::get<2>(returned), .channels = {}};
      for (const std::array<double, 8>& row : std::get<1>(returned)) {
        layout.elements.push_back(
            {.tip = {row[0], row[1], row[2]}, .axis = {row[3], row[4], row[5]}, .k_normal = row[6], .k_tangential = row[7]});
      }
      for (const auto& [channel, unit, shape] : std::get<3>(returned)) layout.channels.push_back({channel, unit, shape, {}});
      set(std::move(layout));
      const std::size_t units = this->layout().units.size(), elements = this->layout().elements.size();
      own_->arrays.emplace(std::vector<Channel>{{"force", "N", {units, 3}, {}},
                                                {"displacement", "m", {units, 3}, {}},
                                                {"depth", "m", {elements}, {}},
                                                {"shear", "m", {3, elements}, {}}});
      own_->shapes = shapes_of(channels());
    });
  }

 private:
  using LayoutValues = std::tuple<double, std::vector<std::array<double, 8>>, std::vector<std::size_t>,
                                  std::vector<std::tuple<std::string, std::string, std::vector<std::size_t>>>>;

  void read(const ContactFrame& truth, std::span<float> values) override {
    const auto span = [](const auto& array) {
      return std::span<const double>(array.data(), static_cast<std::size_t>(array.size()));
    };
    locked(own_->subject, [&] {
      const nb::object frame = own_->frame(
          truth.time, {span(truth.force), span(truth.displacement), span(truth.element_depth), span(truth.element_shear)});
      float* at = values.data();
      for (const nb::handle part : own_->package.attr("readings_of")(own_->call(frame), own_->shapes)) {
        const auto array = nb::cast<nb::ndarray<nb::numpy, const float, nb::c_contig>>(part);
        at = std::copy_n(array.data(), array.size(), at);
      }
    });
  }

  OwnPart<double> own_;
};

// Keeps the class for the lifetime of the process: registered types are never removed.
nb::object* kept(const nb::object& type) { return new nb::object(type); }

void add_detector(const std::string& name, const nb::object& type, const std::string& summary, const Declared& declared) {
  nb::object* const held = kept(type);
  register_detector(entry_of(name, summary, declared), [=](const Parameters& parameters, const FrameSource& source) {
    const ErrorSubject subject{"detector.type", "detector " + name};
    OwnPart<float> own = locked(subject, [&] {
      const nb::object about = nb::module_::import_("slipbench._own")
                                   .attr("Source")(source.sensor, source.type, source.rate, shapes_of(source.channels));
      return OwnPart<float>(new Own<float>(subject, *held, "update", about, keywords_of(parameters, declared), source.channels));
    });
    return std::make_unique<PythonDetector>(std::move(own));
  });
}

void add_controller(const std::string& name, const nb::object& type, const std::string& summary, const Declared& declared) {
  nb::object* const held = kept(type);
  register_controller(entry_of(name, summary, declared), [=](const Parameters& parameters, const GripSource& source) {
    const ErrorSubject subject{"controller.type", "controller " + name};
    OwnPart<float> own = locked(subject, [&] {
      const SensorSource& first = source.sensors.front();
      const nb::object about = nb::module_::import_("slipbench._own")
                                   .attr("Source")(first.name, first.type, first.rate, shapes_of(first.channels), source.preset);
      return OwnPart<float>(new Own<float>(subject, *held, "act", about, keywords_of(parameters, declared), source.channels));
    });
    return std::make_unique<PythonController>(std::move(own));
  });
}

void add_sensor(const std::string& name, const nb::object& type, const std::string& summary, const Declared& declared) {
  nb::object* const held = kept(type);
  SensorKind kind{.about = entry_of(name, summary, declared), .electronics = {}, .users_code = true};
  register_sensor(std::move(kind), [=](const SensorScene& scene, std::uint64_t seed, std::uint64_t trial) {
    const ErrorSubject subject{"sensors." + scene.name + ".type", "sensor " + name};
    OwnPart<double> own = locked(subject, [&] {
      const nb::object about = nb::module_::import_("slipbench._own").attr("SensorSource")(scene.name, seed, trial);
      return OwnPart<double>(new Own<double>(subject, *held, "measure", about, keywords_of(scene.parameters, declared), {}));
    });
    return std::make_unique<PythonSensor>(std::move(own));
  });
}

}  // namespace

void bind_own_parts(nb::module_& module) {
  module.def("register_detector", &add_detector);
  module.def("register_controller", &add_controller);
  module.def("register_sensor", &add_sensor);
  module.def("users_types", &users_types);
}

}  // namespace slipbench::python
