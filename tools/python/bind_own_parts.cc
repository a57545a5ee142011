// Detectors and controllers that are Python classes. Trials run in threads of their own without Python's lock, which is taken for each call.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "sim/core/error.h"
#include "tools/program/catalogue/controller_catalogue.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/python/module.h"

namespace nb = nanobind;

namespace slipbench::python {
namespace {

using Numbers = std::vector<std::pair<std::string, double>>;

// What a frame holds, as numpy arrays by channel that each frame fills anew.
class FrameArrays {
 public:
  explicit FrameArrays(const std::vector<Channel>& channels) {
    std::size_t size = 0;
    for (const Channel& channel : channels) size += channel.size();
    auto* const values = new std::vector<float>(size);
    values_ = values->data();
    const nb::capsule owner(values, [](void* held) noexcept { delete static_cast<std::vector<float>*>(held); });
    float* first = values_;
    for (const Channel& channel : channels) {
      arrays_[nb::str(channel.name.c_str())] =
          nb::cast(nb::ndarray<nb::numpy, const float>(first, channel.shape.size(), channel.shape.data(), owner));
      first += channel.size();
    }
  }
  const nb::dict& filled(const SensorFrame& frame) {
    std::ranges::copy(frame.values, values_);
    return arrays_;
  }

 private:
  float* values_;  // the arrays own it
  nb::dict arrays_;
};

// One Python object of a user's class, for one trial. All of it is made, used and let go of with Python's lock.
struct Own {
  Own(std::string name, const nb::object& type, const char* method, const nb::object& source, const nb::dict& keywords,
      const std::vector<Channel>& channels)
      : whose(std::move(name)),
        package(nb::module_::import_("slipbench._own")),
        frame_type(package.attr("Frame")),
        call(nb::object(type(source, **keywords)).attr(method)),
        arrays(channels) {}

  nb::object frame(const SensorFrame& frame) { return frame_type(frame.time, arrays.filled(frame)); }

  std::string whose;  // "detector mine"
  nb::object package, frame_type, call;
  FrameArrays arrays;
};
struct WithLock {
  void operator()(Own* own) const {
    if (!Py_IsInitialized()) return;  // the interpreter has gone, and what it held with it
    const nb::gil_scoped_acquire acquire;
    delete own;
  }
};
using OwnPart = std::unique_ptr<Own, WithLock>;

// What Python says of an exception. Its text may hold lone surrogates, which no UTF-8 has and nanobind's what() cannot bear.
std::string text_of(const nb::python_error& error) {
  const nb::object lines = nb::module_::import_("traceback").attr("format_exception")(error.value());
  const nb::object text = nb::str("").attr("join")(lines).attr("strip")();
  return nb::cast<nb::bytes>(text.attr("encode")("utf-8", "backslashreplace")).c_str();
}

// `work` with Python's lock; what a class raises is an error of the scene that names it.
template <class Work>
auto locked(const std::string& whose, Work&& work) {
  const nb::gil_scoped_acquire acquire;
  try {
    return work();
  } catch (const nb::python_error& error) {
    throw InputError(whose + ": " + text_of(error));
  } catch (const nb::cast_error&) {
    throw InputError(whose + ": returned something of another type than its method may");
  }
}

nb::dict keywords_of(const Parameters& parameters, const Numbers& declared) {
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

Entry entry_of(const std::string& name, const std::string& summary, const Numbers& declared) {
  Entry entry{.name = name, .summary = summary, .law = {}, .source = "a Python class", .parameters = {}};
  for (const auto& [parameter, value] : declared)
    entry.parameters.push_back(
        number_spec(parameter, Quantity::none, fmt::format("{}", value), any_value, "Of the Python class.", "the class"));
  return entry;
}

class PythonDetector final : public Detector {
 public:
  explicit PythonDetector(OwnPart own) : own_(std::move(own)) {}

  const SlipEstimate& update(const SensorFrame& frame) override {
    locked(own_->whose, [&] { read(own_->call(own_->frame(frame))); });
    estimate_.time = frame.time;
    return estimate_;
  }

 private:
  void read(const nb::object& said) {
    const nb::object estimate = own_->package.attr("estimate_of")(said);
    estimate_.state = static_cast<PadState>(nb::cast<int>(nb::int_(estimate.attr("state"))));
    estimate_.latency = nb::cast<double>(estimate.attr("latency"));
    estimate_.stuck_fraction = nb::cast<double>(estimate.attr("stuck_fraction"));
  }

  OwnPart own_;
  SlipEstimate estimate_;
};

class PythonController final : public Controller {
 public:
  explicit PythonController(OwnPart own) : own_(std::move(own)) {}

  GripCommand update(const ControlInput& input) override {
    locked(own_->whose, [&] {
      const nb::object slip = own_->package.attr("Slip")(static_cast<int>(input.slip.state), input.slip.stuck_fraction,
                                                         input.gripper.position, input.gripper.moving, input.gripper.stopped);
      const nb::object command = own_->package.attr("command_of")(own_->call(own_->frame(input.frame), slip));
      command_.position = nb::cast<int>(command.attr("position"));
      command_.speed = nb::cast<int>(command.attr("speed"));
      command_.force = nb::cast<int>(command.attr("force"));
    });
    return command_;
  }

 private:
  OwnPart own_;
  GripCommand command_;
};

// A maker holds the class for as long as the process lives: what a scene may name never goes.
nb::object* kept(const nb::object& type) { return new nb::object(type); }

void add_detector(const std::string& name, const nb::object& type, const std::string& summary, const Numbers& declared) {
  nb::object* const held = kept(type);
  register_detector(entry_of(name, summary, declared), [=](const Parameters& parameters, const FrameSource& source) {
    const std::string whose = "detector " + name;
    OwnPart own = locked(whose, [&] {
      const nb::object about = nb::module_::import_("slipbench._own")
                                   .attr("Source")(source.sensor, source.type, source.rate, shapes_of(source.channels));
      return OwnPart(new Own(whose, *held, "update", about, keywords_of(parameters, declared), source.channels));
    });
    return std::make_unique<PythonDetector>(std::move(own));
  });
}

void add_controller(const std::string& name, const nb::object& type, const std::string& summary, const Numbers& declared) {
  nb::object* const held = kept(type);
  register_controller(entry_of(name, summary, declared), [=](const Parameters& parameters, const GripSource& source) {
    const std::string whose = "controller " + name;
    OwnPart own = locked(whose, [&] {
      const SensorSource& first = source.sensors.front();
      const nb::object about = nb::module_::import_("slipbench._own")
                                   .attr("Source")(first.name, first.type, first.rate, shapes_of(first.channels), source.preset);
      return OwnPart(new Own(whose, *held, "act", about, keywords_of(parameters, declared), source.channels));
    });
    return std::make_unique<PythonController>(std::move(own));
  });
}

}  // namespace

void bind_own_parts(nb::module_& module) {
  module.def("register_detector", &add_detector);
  module.def("register_controller", &add_controller);
}

}  // namespace slipbench::python
