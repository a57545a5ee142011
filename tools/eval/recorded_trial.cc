#include "tools/eval/recorded_trial.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "detectors/resampling.h"
#include "sim/core/counted.h"
#include "tools/files/reject.h"
#include "tools/trial/recorded_scene.h"

namespace slipbench::eval {
namespace {

// An imported dataset has no scene.
bool has_scene(const DatasetReader& reader) { return !reader.header().scene.empty(); }

// Names of a trial's sensors in the scene's order, which the file does not keep.
std::vector<std::string> ordered_sensors(const DatasetReader& reader, std::size_t trial) {
  std::vector<std::string> names = reader.sensors(trial);
  if (names.size() < 2 || !has_scene(reader)) return names;
  const SceneFile scene = SceneFile::from_text(reader.header().scene, reader.files().front() + ": scene");
  const YamlNode* sensors = scene.root().find("sensors");
  if (sensors == nullptr) return names;
  const auto place = [sensors](const std::string& name) {
    return std::ranges::find(sensors->children, name, &YamlNode::key) - sensors->children.begin();
  };
  std::ranges::stable_sort(names, {}, place);
  return names;
}

std::size_t chosen_sensor(const std::vector<std::string>& names, const std::string& wanted) {
  if (wanted.empty() && names.size() == 1) return 0;
  const auto found = std::ranges::find(names, wanted);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  reject("{}{}",
         wanted.empty() ? std::string("has several sensors; choose one with --sensor") : "unknown sensor " + quote(wanted),
         allowed_names(wanted, names));
}

std::vector<SensorRecord> in_order(TrialRecord& record, const std::vector<std::string>& names) {
  std::vector<SensorRecord> sensors;
  for (const std::string& name : names) {
    sensors.push_back(std::move(*std::ranges::find(record.sensors, name, &SensorRecord::name)));
  }
  record.sensors.clear();
  return sensors;
}

// How many samples `import --rate` interpolated, by the params of a trial; empty: none.
std::string made_up_by_import(const std::string& params, std::size_t samples) {
  const Json known = Json::parse(params, nullptr, false);
  if (!known.is_object() || !known.contains("resampled") || !known.at("resampled").is_object()) return "";
  const Json& resampled = known.at("resampled");
  const auto number = [&](const char* key) {
    const auto found = resampled.find(key);
    return found != resampled.end() && found->is_number_unsigned() ? found->get<std::size_t>() : std::size_t{0};
  };
  const std::size_t made_up = number("samples_made_up"), in_gaps = number("samples_in_gaps");
  if (made_up == 0 && in_gaps == 0) return "";
  const std::string text = fmt::format("`import --rate` interpolated {} of {}{}", made_up > 0 ? made_up : in_gaps,
                                       counted(samples, "sample"), made_up > 0 ? "" : ", in gaps");
  const bool many = made_up > 0 || static_cast<double>(in_gaps) > largest_gap_share * static_cast<double>(samples);
  return text + (many ? "; the figures are of interpolated data" : "");
}

}  // namespace

Truth RecordedTrial::truth(LabelRule rule) const { return truth_of(scene ? &*scene : nullptr, record, sensor(), rule); }

RecordedTrial recorded_trial(const DatasetReader& reader, std::size_t trial, const DetectorScene& detector,
                             const std::string& sensor, const Catalogues& catalogues, bool interpolate) {
  reader.check_recorded(trial);
  RecordedTrial result;
  result.record = reader.read_trial(trial);
  const std::vector<std::string> names = ordered_sensors(reader, trial);
  result.read = chosen_sensor(names, sensor);
  result.sensors = in_order(result.record, names);
  result.replayed = replay(detector, result.sensors, result.read, result.record.seed, trial, interpolate);
  if (const std::string made_up = made_up_by_import(result.record.params, result.record.num_samples()); !made_up.empty()) {
    std::string& notice = result.replayed.notice;
    notice += (notice.empty() ? "" : "; ") + made_up;
  }
  if (has_scene(reader)) result.scene = recorded_scene(recorded_file(reader), result.record, catalogues);
  return result;
}

void Notices::add(const std::string& notice) {
  if (notice.empty()) return;
  if (first_.empty()) first_ = notice;
  others_ += notice == first_ ? 0 : 1;
}

std::string Notices::text() const {
  return others_ == 0 ? first_ : fmt::format("{}; {} in a similar way", first_, counted(others_, "other trial"));
}

Json parameters_json(const Parameters& parameters) {
  Json json = Json::object();
  for (const auto& [name, value] : parameters.values()) {
    std::visit(
        [&json, &key = name](const auto& held) {
          if constexpr (std::is_same_v<std::decay_t<decltype(held)>, double>) {
            json[key] = std::isfinite(held) ? Json(held) : Json(fmt::format("{}", held));
          } else if constexpr (std::is_same_v<std::decay_t<decltype(held)>, NumberTable>) {
            json[key] = held.rows;
          } else {
            json[key] = held;
          }
        },
        value);
  }
  return json;
}

}  // namespace slipbench::eval
