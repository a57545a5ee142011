// The program's side of sim/core/plugin_abi.h: what sensors, detectors and controllers from shared libraries have in common.
#pragma once

#include <cstddef>
#include <exception>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/core/plugin_abi.h"
#include "sim/core/sensor_frame.h"

namespace slipbench {

// A shared library, or code of the same interface that the program is built with. A library stays loaded when the object goes, since threads that
// it has started may run on; one that has changed since needs another start of the program. Whatever it does wrong is a SceneValueError at
// `where`.library, or .type: the message names the library, and the function where one is to blame. A crash of it, or a call of exit(), ends the program.
class PluginLibrary {
 public:
  // `part`: "sensor", "detector" or "controller"; `path`: what the scene names, or the default "none"; `own`: what the program was built
  // with. Throws SceneValueError where no library is named, where there is no such file, where it cannot be loaded, lacks a
  // symbol or was built with anything else than `own`. `where`: the part in the scene, "sensors.pad"; "": `part`.
  PluginLibrary(std::string part, const std::string& path, const slipbench_abi& own, std::string where = {});
  // What the program is built with, `key` being the scene's for it: nothing is loaded. For call() and refuse() alone.
  PluginLibrary(std::string part, std::string where, std::string key, std::string name);
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  // What the library declares as its parameters, with the values of `given`. Throws SceneValueError at `where`.parameters.<name>
  // for a name that the library does not declare and a value that is not of the declared type, and at `where`.library for a
  // declaration that is none.
  class Values {
   public:
    Values() = default;
    Values(Values&&) = default;                                                            // what is handed points into it
    [[nodiscard]] std::span<const slipbench_parameter> handed() const { return handed_; }  // valid as long as the object lives

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

  // The function slipbench_make_<part>, of the type Make.
  template <class Make>
  [[nodiscard]] Make* maker() const {
    return reinterpret_cast<Make*>(symbol("slipbench_make_" + part_));  // as POSIX has it
  }

  // Runs call(), which is to call `function` of the library and nothing else. Throws SceneValueError where that throws.
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
    refuse("threw " + thrown + " in " + function + "; allowed: no exceptions");
  }

  // Throws SceneValueError at `where`.library, or .type: "'mine.so' " and `what`.
  [[noreturn]] void refuse(const std::string& what) const;
  // Likewise where the library made no object, for the reason that it left in `refusal`, which need not end.
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

// The sensors of a scene as a library sees them. Valid as long as the object lives.
class PluginSensors {
 public:
  explicit PluginSensors(const std::vector<SensorSource>& sensors);  // which must outlive the object
  [[nodiscard]] std::span<const slipbench_sensor> handed() const { return sensors_; }

 private:
  std::vector<std::vector<slipbench_channel>> channels_;
  std::vector<slipbench_sensor> sensors_;
};

// What a library makes for one trial: a slipbench_readout, slipbench_detector or slipbench_controller.
template <class Object>
class PluginObject {
 public:
  // Loads the library that `parameters` name; the rest as PluginLibrary.
  PluginObject(const std::string& part, const Parameters& parameters, const slipbench_abi& own, std::string where = {})
      : library(part, parameters.path("library"), own, std::move(where)), function_("slipbench_make_" + part) {}
  // Of what the program is built with as `type`.
  PluginObject(const std::string& part, const std::string& type, std::string where)
      : library(part, std::move(where), "type", quote(type)), function_("slipbench_make_" + part) {}
  PluginObject(const PluginObject&) = delete;  // owns what the library made
  PluginObject& operator=(const PluginObject&) = delete;
  ~PluginObject() {
    try {
      finish();
    } catch (const SceneValueError&) {
      // Another error is under way: a trial that ends well calls finish() itself.
    }
  }

  // Has the object made by the library's Make, as it is now handed over. `works`: the member that is null where there is none. Throws
  // SceneValueError where there is none, for the library's reason, and as PluginLibrary::parameters().
  template <class Make, class Function>
  void make(const Parameters& parameters, const std::vector<SensorSource>& sensors, std::size_t own, Function Object::*works) {
    const PluginLibrary::Values values = library.parameters(parameters.map("parameters"));
    make(library.maker<Make>(), values.handed(), sensors, own, works);
  }

  // Likewise by `made`, from these parameters.
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

  // Ends the object. Throws SceneValueError where that throws.
  void finish() {
    const auto destroy = std::exchange(object.destroy, nullptr);
    if (destroy != nullptr) library.call("destroy", [&] { destroy(object.self); });
  }

  PluginLibrary library;  // outlives what it made
  Object object{};

 private:
  std::string function_;
};

// What the sensors of a scene have said since a library was called last.
class PluginSamples {
 public:
  explicit PluginSamples(const std::vector<SensorSource>& sensors);

  void add(std::size_t sensor, const SensorFrame& sample);
  // As the library gets it, in the order of sensors; valid until the next call of another function.
  std::span<const slipbench_samples> handed();
  // What has been added is no longer new.
  void forget();

 private:
  struct Sensor {
    std::size_t size = 0;  // values of a sample
    std::vector<float> values;
    std::vector<double> times;
    std::vector<float> latest;  // empty: none yet; up to date where nothing is new
    double latest_time = 0.0;
  };
  std::vector<Sensor> sensors_;
  std::vector<slipbench_samples> handed_;
};

// The parameters that the catalogue's entry of such a part has: "library" and "parameters".
std::vector<ParameterSpec> plugin_specs();

}  // namespace slipbench
