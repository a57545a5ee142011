#include "tools/trial/recorded_scene.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <variant>

#include "sim/core/error.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/scene/entry_reader.h"

namespace slipbench {
namespace {

// Keys for the pose and motion of an object, which do not identify it.
constexpr std::array<std::string_view, 5> of_place{"angle", "free", "position", "rotation", "velocity"};

struct Text {
  std::string operator()(double value) const { return json_number(value); }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(const std::string& value) const { return json_text(value); }
  std::string operator()(const std::vector<double>& values) const {
    std::string text;
    for (const double value : values) text += json_number(value) + ",";
    return text;
  }
  std::string operator()(const NumberTable& table) const {
    std::string text;
    for (const std::vector<double>& row : table.rows) text += (*this)(row) + "/";
    return text;
  }
  std::string operator()(const ParameterMap& values) const {
    std::string text;
    for (const auto& [name, value] : values) text += json_text(name) + "=" + json_text(value) + ",";
    return text;
  }
};

std::string text_of(const std::string& name, const Parameters& parameters) {
  std::string text = name + ":";
  for (const auto& [key, value] : parameters.values()) {
    if (std::ranges::find(of_place, key) == of_place.end()) text += key + "=" + std::visit(Text{}, value) + ";";
  }
  return text;
}

std::string object_of(const Scene& scene) {
  std::string text = scene.material + "|";
  if (scene.grasp) return text + text_of("box", scene.grasp->box);
  if (!scene.dynamic()) return text + text_of(scene.surface.name, scene.surface.parameters);
  text += scene.model;
  for (const BodyScene& body : scene.bodies) text += "|" + text_of(body.shape.name, body.shape.parameters);
  return text;
}

std::string speed_of(const Scene& scene) {
  const auto& values = scene.motion.parameters.values();
  const auto speed = values.find("speed");
  if (speed != values.end()) return json_number(std::get<double>(speed->second));
  throw SceneValueError("split.by", "the motion '" + scene.motion.name + "' has no speed; allowed: material, object, trial");
}

bool only_changes_reading(const Scene& scene, const std::string& path) {
  if (path == "seed" || path == "time_step" || path == "fidelity" || path == "duration") return true;
  if (path == "detector" || path.starts_with("detector.")) return !scene.controller;
  if (!path.starts_with("sensors.")) return false;
  const std::size_t key = path.find('.', std::string_view("sensors.").size());
  const std::string of_sensor = key == std::string::npos ? "" : path.substr(key + 1);
  return of_sensor == "rate" || of_sensor == "electronics" || of_sensor.starts_with("electronics.");
}

}  // namespace

Json json_object(const std::string& text, const std::string& subject) {
  Json values = Json::parse(text, nullptr, false);
  if (!values.is_object()) throw InputError(subject + " is not a JSON object: " + text.substr(0, 60));
  return values;
}

SceneFile recorded_file(const std::string& scene, const Json& overrides, const std::string& place) {
  SceneFile file = SceneFile::from_text(scene, place);
  for (const auto& [path, value] : overrides.items()) {
    if (!value.is_string()) throw InputError(place + ": the overrides contain no text for " + path);
    // The run may have added the key before it removed it; the dataset keeps the last value only.
    // The user of the dataset did not type it.
    const Override change{
        .path = path, .value = value.get<std::string>(), .option = "recorded --set", .of_sweep = false, .callers_own = false};
    file.apply(change, SceneFile::MissingKey::ignored);
  }
  // Up to version 0.3.0 a scene could require an accuracy; the overrides have the setting found for it.
  if (file.root().find("accuracy") != nullptr) file.apply({"accuracy", "null"});
  return file;
}

SceneFile recorded_file(const DatasetReader& reader) {
  SceneFile file =
      recorded_file(reader.header().scene, json_object(reader.header().overrides, "attribute overrides"), "attribute scene");
  file.apply({"sweep", "{}"});
  return file;
}

Scene recorded_scene(SceneFile file, const TrialRecord& record, const Catalogues& catalogues) {
  const Json params = json_object(record.params, "attribute params");
  for (const auto& [path, value] : params.items()) {
    if (!value.is_null())
      file.apply({.path = path, .value = value.is_string() ? value.get<std::string>() : value.dump(), .of_sweep = true});
  }
  return parse_scene(file, catalogues);
}

std::optional<SplitRule> split_rule(const Scene& scene) {
  if (!scene.split) return std::nullopt;
  const std::vector<double>& shares = scene.split->vector("shares");
  return SplitRule{scene.split->choice("by"), {shares[0], shares[1], shares[2]}};
}

std::string split_group(const Scene& scene) {
  const std::string by = scene.split ? scene.split->choice("by") : "material";
  if (by == "object") return object_of(scene);
  return by == "speed" ? speed_of(scene) : scene.material;
}

std::string experiment_of(const Scene& scene, const std::vector<std::pair<std::string, std::string>>& swept) {
  if (find_motion(scene.motion.name)->is_random(scene.motion.parameters)) return "";
  if (scene.grasp && (scene.grasp->scatter || scene.grasp->grip.number("drift") != 0.0)) return "";
  std::string text = "experiment";
  for (const auto& [path, value] : swept) {
    if (!only_changes_reading(scene, path)) text += ";" + json_text(path) + "=" + json_text(value);
  }
  return text;
}

std::vector<std::string> experiments_of(const Scene& scene, const std::vector<std::pair<std::string, std::string>>& swept,
                                        const std::string& truth) {
  std::vector<std::string> keys;
  if (!truth.empty()) keys.push_back("truth " + truth);
  const bool read_otherwise = std::ranges::any_of(swept, [&](const auto& one) { return only_changes_reading(scene, one.first); });
  if (const std::string values = read_otherwise ? experiment_of(scene, swept) : ""; !values.empty()) keys.push_back(values);
  return keys;
}

}  // namespace slipbench
