// The program's side of sim/api/plugin_abi.h, shared by sensors, detectors and controllers from
// libraries.
#pragma once

#include <cstddef>
#include <exception>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/api/plugin_abi.h"
#include "sim/api/sensor_frame.h"
#include "sim/core/error.h"
#include "sim/core/parameters.h"

namespace slipbench {

// A shared library, or code of the same interface that is built into the program. A library stays
// loaded after the object is destroyed, since threads that it started may still run; if its file
// changes, the program must be restarted. Errors of the library are a SceneValueError at
// `where`.library, or .type: the message names the library, and the function if one is at fault. A
// crash of the library, or a call of exit(), ends the program.
class PluginLibrary {
 public:
  // `part`: "sensor", "detector" or "controller". `path`: as in the scene, or the default "none".
  // `own`: the version and sizes of the program. `where`: the part in the scene, "sensors.pad"; "":
  // `part`. Throws SceneValueError if no library is named, there is no such file, it cannot be
  // loaded, it lacks a symbol, or it was built with anything else than `own`.
  PluginLibrary(std::string part, const std::string& path, const slipbench_abi& own, std::string where = {});
  // For code that is built into the program; `key` is its key in the scene. Loads nothing: only
  // call() and refuse() may be used.
  PluginLibrary(std::string part, std::string where, std::string key, std::string name);
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  // The parameters that the library declares, with the values of `given`. Throws SceneValueError at
  // `where`.parameters.<name> for a name that the library does not declare and a value that is not
  // of the declared type, and at `where`.library for an invalid declaration.
  class Values {
   public:
    Values() = default;
    Values(Values&&) = default;  // not copied: handed_ points into values_
    // valid while the object lives
    [[nodiscard]] std::span<const slipbench_parameter> handed() const { return handed_; }

   private:
    friend class PluginLibrary;
    struct Value {
      std::string name, text, unit;
      int type;
      double number;
    };
    std::vector<Value> values_;
    std::vector<slipbench_parameter> handed_;
  };
  [[nodiscard]] Values parameters(const ParameterMap& given);

  // Returns the function slipbench_make_<part>, of the type Make.
  template <class Make>
  [[nodiscard]] Make* maker() const {
    return reinterpret_cast<Make*>(symbol("slipbench_make_" + part_));  // POSIX allows this cast
  }

  // Runs call(), which must call `function` of the library and nothing else. Throws SceneValueError
  // if `function` throws.
  template <class Call>
  void call(const std::string& function, Call&& call) {
    std::string thrown;
    try {
      call();
      return;
    } catch (const std::exception& error) {
      thrown = quote(error.what());
    } catch (...) {
      thrown = "an exception";
    }
    refuse("threw " + thrown + " in " + function + ", but a plugin must not throw");
  }

  // Throws SceneValueError at `where`.library, or .type, with the text "'mine.so' " and `what`.
  [[noreturn]] void refuse(const std::string& what) const;
  // The same if the library made no object, with the reason in `refusal`, which may lack its
  // terminating zero.
  [[noreturn]] void refuse_scene(const char (&refusal)[SLIPBENCH_REFUSAL_SIZE]) const;

 private:
  [[nodiscard]] void* symbol(const std::string& name) const;
  void check_build(const slipbench_abi& own);
  std::vector<Values::Value> declared();
  void take(const std::string& text, Values::Value& value) const;

  std::string part_, where_, key_;
  std::string name_;  // for messages: the path or type in quotes
  void* handle_ = nullptr;
};

// The sensors of a scene as a library sees them. Valid while the object lives.
class PluginSensors {
 public:
  // `sensors` must outlive the object
  explicit PluginSensors(const std::vector<SensorSource>& sensors);
  [[nodiscard]] std::span<const slipbench_sensor> handed() const { return sensors_; }

 private:
  std::vector<std::vector<slipbench_channel>> channels_;
  std::vector<slipbench_sensor> sensors_;
};

// In this process, no longer destroys the objects that libraries make. For a child process that only
// checks scenes: a crash in `destroy` then fails the trials in which it happens, and not the check.
void keep_plugin_objects();
[[nodiscard]] bool plugin_objects_stay();

// The object that a library makes for one trial: a slipbench_readout, slipbench_detector or
// slipbench_controller.
template <class Object>
class PluginObject {
 public:
  // Loads the library that `parameters` name; otherwise like PluginLibrary.
  PluginObject(const std::string& part, const Parameters& parameters, const slipbench_abi& own, std::string where = {})
      : library(part, parameters.path("library"), own, std::move(where)), function_("slipbench_make_" + part) {}
  // For code of the type `type` that is built into the program.
  PluginObject(const std::string& part, const std::string& type, std::string where)
      : library(part, std::move(where), "type", quote(type)), function_("slipbench_make_" + part) {}
  PluginObject(const PluginObject&) = delete;  // owns the library's object
  PluginObject& operator=(const PluginObject&) = delete;
  ~PluginObject() {
    try {
      finish();
    } catch (const SceneValueError&) {
      // Does not throw, because another error is already being handled: a trial that ends normally
      // calls finish() itself.
    }
  }

  // Has the library's Make create the object. `own`: index of the object's sensor. `works`: the
  // member that is null if no object was made. Throws SceneValueError with the library's reason if
  // it made none, and as PluginLibrary::parameters().
  template <class Make, class Function>
  void make(const Parameters& parameters, const std::vector<SensorSource>& sensors, std::size_t own, Function Object::*works) {
    const PluginLibrary::Values values = library.parameters(parameters.map("parameters"));
    make(library.maker<Make>(), values.handed(), sensors, own, works);
  }

  // The same with the function `made` and these parameters.
  template <class Make, class Function>
  void make(Make* made, std::span<const slipbench_parameter> parameters, const std::vector<SensorSource>& sensors,
            std::size_t own, Function Object::*works) {
    const PluginSensors seen(sensors);
    const slipbench_source about{.sensors = seen.handed().data(),
                                 .sensor_count = seen.handed().size(),
                                 .sensor = own,
                                 .parameters = parameters.data(),
                                 .parameter_count = parameters.size()};
    library.call(function_, [&] { made(&about, &object); });
    if (object.*works != nullptr) return;
    finish();
    library.refuse_scene(object.refusal);
  }

  // Destroys the object. Throws SceneValueError if that throws.
  void finish() {
    const auto destroy = std::exchange(object.destroy, nullptr);
    if (destroy != nullptr && !plugin_objects_stay()) library.call("destroy", [&] { destroy(object.self); });
  }

  PluginLibrary library;  // must outlive its object
  Object object{};

 private:
  std::string function_;
};

// The samples of a scene's sensors since the last call of a library.
class PluginSamples {
 public:
  explicit PluginSamples(const std::vector<SensorSource>& sensors);

  void add(std::size_t sensor, const SensorFrame& sample);
  // Returns the samples in the library's format, in the order of sensors. Valid until the next call
  // of another member function.
  std::span<const slipbench_samples> handed();
  // Marks all added samples as old.
  void forget();

 private:
  struct Sensor {
    std::size_t size = 0;  // values of a sample
    std::vector<float> values;
    std::vector<double> times;
    std::vector<float> latest;  // empty before the first sample; may be older than `values`
    double latest_time = 0.0;
  };
  std::vector<Sensor> sensors_;
  std::vector<slipbench_samples> handed_;
};

// The parameters of a catalogue entry of such a part: "library" and "parameters".
std::vector<ParameterSpec> plugin_specs();

}  // namespace slipbench
