#include "sim/plugins/plugin_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string_view>

#include "sim/core/counted.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

constexpr const char* no_library = "none";
constexpr std::size_t max_parameters = 1000;
constexpr std::size_t max_text = 4096;  // bytes of a name or a text that a library declares

std::mutex loader;

// Guarded by `loader`: tells a loaded library from a newer file of the same name, for which the
// loader would return the old library.
using Stamp = std::pair<std::uintmax_t, std::filesystem::file_time_type>;  // size, write time
std::map<std::string, Stamp>& stamps() {
  static auto* const known = new std::map<std::string, Stamp>;
  return *known;
}
Stamp stamp_of(const std::string& file) {
  // a file that cannot be read cannot be loaded either, and dlopen() reports why
  std::error_code gone;
  return {std::filesystem::file_size(file, gone), std::filesystem::last_write_time(file, gone)};
}

// The sizes in the order of slipbench_abi.
struct Size {
  const char* structure;
  unsigned slipbench_abi::*member;
};
std::array<Size, 8> sizes_of(const std::string& part) {
  using Names = std::array<const char*, 3>;
  const Names own = part == "detector" ? Names{"slipbench_detector", "slipbench_detector_input", "slipbench_estimate"}
                    : part == "sensor" ? Names{"slipbench_readout", "slipbench_contact", "slipbench_element"}
                                       : Names{"slipbench_controller", "slipbench_control_input", "slipbench_grip_command"};
  return {{{"slipbench_parameter", &slipbench_abi::parameter_size},
           {"slipbench_channel", &slipbench_abi::channel_size},
           {"slipbench_sensor", &slipbench_abi::sensor_size},
           {"slipbench_source", &slipbench_abi::source_size},
           {"slipbench_samples", &slipbench_abi::samples_size},
           {own[0], &slipbench_abi::object_size},
           {own[1], &slipbench_abi::input_size},
           {own[2], &slipbench_abi::result_size}}};
}

std::atomic<bool> objects_stay{false};

// Copies a text of a library, which may lack its terminating zero.
std::string bounded_text(const char* text) { return text == nullptr ? "" : std::string(text, strnlen(text, max_text)); }

// Returns the quantity whose SI unit is `unit`. Throws std::invalid_argument for an unknown unit.
Quantity quantity_in(const std::string& unit) {
  if (unit.empty()) return Quantity::none;
  const Quantity quantity = quantity_of("1 " + unit);
  if (si_symbol(quantity) != unit) throw std::invalid_argument("allowed: " + std::string(si_symbol(quantity)));
  return quantity;
}

}  // namespace

void keep_plugin_objects() { objects_stay = true; }

bool plugin_objects_stay() { return objects_stay; }

PluginLibrary::PluginLibrary(std::string part, std::string where, std::string key, std::string name)
    : part_(std::move(part)),
      where_(where.empty() ? part_ : std::move(where)),
      key_(where_ + "." + std::move(key)),
      name_(std::move(name)) {}

PluginLibrary::PluginLibrary(std::string part, const std::string& path, const slipbench_abi& own, std::string where)
    : PluginLibrary(std::move(part), std::move(where), "library", "'" + path + "'") {
  if (path == no_library) throw SceneValueError(key_, "no library is given; expected the path of a shared library");
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    const bool there = std::filesystem::exists(path, error);
    throw SceneValueError(key_,
                          name_ + (there ? " is not a file" : " does not exist") + "; expected the path of a shared library");
  }
  // a bare name would be searched for in the library path
  const std::string file = std::filesystem::absolute(path).string();
  {
    const std::lock_guard<std::mutex> lock(loader);
    const Stamp stamp = stamp_of(file);
    if (stamps().emplace(file, stamp).first->second != stamp) refuse("has changed since it was loaded; restart the program");
    call("a constructor of the library", [&] { handle_ = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL); });
    if (handle_ == nullptr) {
      stamps().erase(file);
      throw SceneValueError(key_, "cannot load " + name_ + ": " + dlerror());
    }
  }
  check_build(own);
  static_cast<void>(symbol("slipbench_make_" + part_));
}

void PluginLibrary::refuse(const std::string& what) const { throw SceneValueError(key_, name_ + " " + what); }

void PluginLibrary::refuse_scene(const char (&refusal)[SLIPBENCH_REFUSAL_SIZE]) const {
  const std::string why(refusal, strnlen(refusal, sizeof refusal));
  refuse("makes no " + part_ + " for this scene" + (why.empty() ? " and gives no reason" : ": " + quote(why)));
}

void* PluginLibrary::symbol(const std::string& name) const {
  void* const address = dlsym(handle_, name.c_str());
  if (address == nullptr) {
    refuse("has no symbol '" + name + "'; it must export what " + part_ + "s/plugin_abi.h declares");
  }
  return address;
}

void PluginLibrary::check_build(const slipbench_abi& own) {
  const std::string name = "slipbench_" + part_ + "_abi";
  const auto* const at = static_cast<const char*>(symbol(name));
  slipbench_abi found{};
  // A library of another version may contain nothing but its version.
  std::memcpy(&found.version, at, sizeof found.version);
  if (found.version != own.version) {
    refuse("was built for version " + std::to_string(found.version) + " of the " + part_ +
           " interface; allowed: " + std::to_string(own.version));
  }
  std::memcpy(&found, at, sizeof found);
  for (const Size& size : sizes_of(part_)) {
    if (found.*size.member == own.*size.member) continue;
    refuse("was built with a " + std::string(size.structure) + " of " + counted(found.*size.member, "byte") +
           "; allowed: " + std::to_string(own.*size.member));
  }
}

std::vector<PluginLibrary::Values::Value> PluginLibrary::declared() {
  const std::string name = "slipbench_" + part_ + "_parameters";
  const auto* const table = static_cast<const slipbench_parameter*>(dlsym(handle_, name.c_str()));
  std::vector<Values::Value> values;
  if (table == nullptr) return values;
  for (const slipbench_parameter* row = table; row->name != nullptr && *row->name != '\0' && values.size() <= max_parameters;
       ++row) {
    values.push_back({bounded_text(row->name), bounded_text(row->text), bounded_text(row->unit), row->type, row->number});
  }
  const std::string where = "has an invalid " + name + ": ";
  if (values.size() > max_parameters) {
    refuse(where + "more than " + std::to_string(max_parameters) + " parameters; the last row must be SLIPBENCH_NO_MORE");
  }
  for (const Values::Value& value : values) {
    const std::string what = where + quote(value.name) + " ";
    if (!is_identifier(value.name)) refuse(what + "is not a name; allowed: letters, digits and '_', no digit first");
    const auto same = [&](const Values::Value& other) { return other.name == value.name; };
    if (std::ranges::count_if(values, same) != 1) refuse(what + "is declared twice");
    if (value.type < SLIPBENCH_NUMBER || value.type > SLIPBENCH_BOOLEAN) {
      refuse(what + "has the type " + std::to_string(value.type) +
             "; allowed: SLIPBENCH_NUMBER, SLIPBENCH_TEXT, SLIPBENCH_BOOLEAN, which are 1, 2, 3");
    }
    if (value.type != SLIPBENCH_TEXT && !std::isfinite(value.number)) {
      refuse(what + "has the default " + format_number(value.number) + "; allowed: a finite number");
    }
    try {
      static_cast<void>(quantity_in(value.unit));
    } catch (const std::invalid_argument&) {
      refuse(what + "has the unit " + quote(value.unit) + "; allowed: an SI unit of scenes, such as N, m, s, m/s or Hz, or none");
    }
  }
  return values;
}

void PluginLibrary::take(const std::string& text, Values::Value& value) const {
  if (value.type == SLIPBENCH_TEXT) {
    value.text = text;
  } else if (value.type == SLIPBENCH_BOOLEAN) {
    if (text != "true" && text != "false") throw std::invalid_argument(quote(text) + " is not a flag; allowed: true, false");
    value.number = text == "true" ? 1.0 : 0.0;
  } else {
    value.number = parse_quantity(text, quantity_in(value.unit));
    if (!std::isfinite(value.number)) throw std::invalid_argument(quote(text) + " is infinite; allowed: a finite number");
  }
}

PluginLibrary::Values PluginLibrary::parameters(const ParameterMap& given) {
  Values values;
  values.values_ = declared();
  for (const auto& [name, text] : given) {
    const std::string key = where_ + ".parameters." + name;
    const auto found = std::ranges::find(values.values_, name, &Values::Value::name);
    if (found == values.values_.end()) {
      std::vector<std::string> names;
      for (const Values::Value& value : values.values_) names.push_back(value.name);
      throw SceneValueError(key, name_ + " has no parameter " + quote(name) + allowed_names(name, names));
    }
    try {
      take(text, *found);
    } catch (const std::invalid_argument& error) {
      throw SceneValueError(key, error.what());
    }
  }
  for (const Values::Value& value : values.values_) {
    const bool is_text = value.type == SLIPBENCH_TEXT;
    values.handed_.push_back({.name = value.name.c_str(),
                              .type = value.type,
                              .number = is_text ? 0.0 : value.number,
                              .text = is_text ? value.text.c_str() : "",
                              .unit = value.unit.c_str()});
  }
  return values;
}

PluginSensors::PluginSensors(const std::vector<SensorSource>& sensors) : channels_(sensors.size()) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    std::size_t first = 0;
    for (const Channel& channel : sensors[i].channels) {
      channels_[i].push_back(
          {channel.name.c_str(), channel.unit.c_str(), channel.shape.data(), channel.shape.size(), first, channel.size()});
      first += channel.size();
    }
    sensors_.push_back(
        {sensors[i].name.c_str(), sensors[i].type.c_str(), sensors[i].rate, channels_[i].data(), channels_[i].size(), first});
  }
}

PluginSamples::PluginSamples(const std::vector<SensorSource>& sensors) : sensors_(sensors.size()), handed_(sensors.size()) {
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    for (const Channel& channel : sensors[i].channels) sensors_[i].size += channel.size();
  }
}

void PluginSamples::add(std::size_t sensor, const SensorFrame& sample) {
  Sensor& about = sensors_.at(sensor);
  if (sample.values.size() != about.size) throw std::logic_error("a sample of another size than its sensor announced");
  about.values.insert(about.values.end(), sample.values.begin(), sample.values.end());
  about.times.push_back(sample.time);
}

std::span<const slipbench_samples> PluginSamples::handed() {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    Sensor& sensor = sensors_[i];
    if (!sensor.times.empty()) {
      sensor.latest.assign(sensor.values.end() - static_cast<std::ptrdiff_t>(sensor.size), sensor.values.end());
      sensor.latest_time = sensor.times.back();
    }
    const bool any = !sensor.latest.empty();
    handed_[i] = {.values = sensor.values.data(),
                  .times = sensor.times.data(),
                  .count = sensor.times.size(),
                  .latest = any ? sensor.latest.data() : nullptr,
                  .latest_time = any ? sensor.latest_time : std::numeric_limits<double>::quiet_NaN()};
  }
  return handed_;
}

void PluginSamples::forget() {
  for (Sensor& sensor : sensors_) {
    sensor.values.clear();
    sensor.times.clear();
  }
}

std::vector<ParameterSpec> plugin_specs() {
  return {path_spec("library", no_library, "The shared library.", "set for each scene"),
          map_spec("parameters", "Parameters that the library declares; a parameter that is left out has the library's default.",
                   "set for each scene")};
}

}  // namespace slipbench
