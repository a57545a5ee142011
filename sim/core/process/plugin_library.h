// The program's side of sim/core/plugin_abi.h: what sensors, detectors and controllers from shared libraries have in common.
#pragma once

#include <array>
#include <cstddef>
#include <exception>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/parameters.h"
#include "sim/core/plugin_abi.h"
#include "sim/core/process/crash_guard.h"
#include "sim/core/sensor_frame.h"

namespace slipbench {

// A call into a library, noted where those can read it who outlive the process that makes it.
struct NotedCall {
  std::array<char, 128> key{};       // of the scene: "detector.library"
  std::array<char, 1024> library{};  // in quotes
  std::array<char, 64> function{};   // empty: no call is under way
};

// Notes code of others that is no library for as long as it lives, where calls are noted.
class NotedWork {
 public:
  NotedWork(const std::string& key, const std::string& whose, const std::string& function);
  NotedWork(const NotedWork&) = delete;
  NotedWork& operator=(const NotedWork&) = delete;
  ~NotedWork();
};

// A shared library, or code of the same interface that the program is built with. A library stays loaded when the object goes, since threads that
// it has started may run on; one that has changed since needs another start of the program. Whatever it does wrong is a SceneValueError at
// `where`.library, or .type: the message names the library, and the function where one is to blame. Exception: a call of exit() while the object lives ends the
// program, as it must, but with status 2 and a line on stderr that names the library.
class PluginLibrary {
 public:
  // `part`: "sensor", "detector" or "controller"; `path`: what the scene names, or the default "none"; `own`: what the program was built
  // with. Throws SceneValueError where no library is named, where there is no such file, where it cannot be loaded, lacks a
  // symbol or was built with anything else than `own`. `where`: the part in the scene, "sensors.pad"; "": `part`.
  PluginLibrary(std::string part, const std::string& path, const slipbench_abi& own, std::string where = {});
  // What the program is built with, `key` being the scene's for it: nothing is loaded. For guarded() and refuse() alone.
  PluginLibrary(std::string part, std::string where, std::string key, std::string name);
  PluginLibrary(const PluginLibrary&) = delete;
  PluginLibrary& operator=(const PluginLibrary&) = delete;

  // Whether the process has loaded one, or tried to. Its threads and its destructors may crash while the process ends, so that it should end by
  // std::_Exit().
  static bool any();

  // For a process that may be lost: from here on `place` holds the call that is under way, and a crash ends the process, as exit() does, unheard.
  static void note_calls(NotedCall& place);

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

  // Runs call(), which is to call `function` of the library and nothing else. Throws SceneValueError where that crashes or
  // throws. After a crash the library is called no more: has_crashed().
  template <class Call>
  void guarded(const std::string& function, Call&& call) {
    std::string thrown;  // outside of what a crash may jump over
    auto caught = [&] {
      try {
        call();
      } catch (const std::exception& error) {
        thrown = quote(error.what());
      } catch (...) {
        thrown = "an exception";
      }
    };
    const bool noted = note(function);
    int signal = 0;
    if (noted) {
      caught();
    } else {
      signal = run_guarded(caught);
    }
    settle(function, signal, thrown);
  }

  [[nodiscard]] bool has_crashed() const { return crashed_; }

  // Throws SceneValueError at `where`.library, or .type: "'mine.so' " and `what`.
  [[noreturn]] void refuse(const std::string& what) const;
  // Likewise where the library made no object, for the reason that it left in `refusal`, which need not end.
  [[noreturn]] void refuse_scene(const char (&refusal)[SLIPBENCH_REFUSAL_SIZE]) const;

 private:
  [[nodiscard]] void* symbol(const std::string& name) const;
  void check_build(const slipbench_abi& own);
  // Whether calls are noted; then so is this one, until settle().
  [[nodiscard]] bool note(const std::string& function) const;
  void settle(const std::string& function, int signal, const std::string& thrown);
  std::vector<Values::Value> declared();
  void take(const std::string& text, Values::Value& value) const;

  // Notes a library under its name while it may be at work, for a call of exit().
  class AtWork {
   public:
    explicit AtWork(std::string name);
    AtWork(const AtWork&) = delete;
    AtWork& operator=(const AtWork&) = delete;
    ~AtWork();

   private:
    std::string name_;
  };

  std::string part_, where_, key_;
  std::string name_;               // for messages: the path or type in quotes
  std::optional<AtWork> at_work_;  // of a library
  void* handle_ = nullptr;
  bool crashed_ = false;
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
    library.guarded(function_, [&] { made(&about, &object); });
    if (object.*works != nullptr) return;
    finish();
    library.refuse_scene(object.refusal);
  }

  // Ends the object. Throws SceneValueError where that crashes or throws.
  void finish() {
    const auto destroy = std::exchange(object.destroy, nullptr);
    if (destroy != nullptr && !library.has_crashed()) library.guarded("destroy", [&] { destroy(object.self); });
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
