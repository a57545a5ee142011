#include "tools/eval/detect.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "sim/api/pad_state_names.h"
#include "sim/core/choice.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/eval/detect_page.h"
#include "tools/eval/recorded_trial.h"
#include "tools/files/given_once.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"
#include "tools/registry/program_catalogues.h"

namespace slipbench::eval {
namespace {

constexpr const char* alarms_head = "recording,trial,object,alarm,begin_s,end_s,probability\n";
constexpr const char* samples_head = "recording,trial,object,time_s,state,slip,probability,label\n";

Json words_of(const std::vector<PadState>& states) {
  Json words = Json::array();
  for (const PadState state : states) words.push_back(state == unknown_state ? Json() : Json(choice_name(pad_states, state)));
  return words;
}

// The rule of a trial's labels; empty if it has none.
std::optional<LabelRule> rule_of(const SensorRecord& sensor, LabelRule simulated) {
  if (sensor.labels.truth) return simulated;
  if (sensor.labels.state_paper.empty()) return std::nullopt;
  return LabelRule::recorded;
}

// The recording's name of the touched object; empty if it has none.
std::string recorded_object(const std::string& params) {
  const Json known = Json::parse(params, nullptr, false);
  return known.is_object() && known.contains("object") && known.at("object").is_string() ? known.at("object") : "";
}

Json detected_trial(const std::string& recording, const RecordedTrial& trial, LabelRule simulated) {
  const SensorRecord& sensor = trial.sensor();
  const Replayed& replayed = trial.replayed;
  const std::vector<double>& time = sensor.time;
  const double duration = time.size() > 1 ? time.back() - time.front() : 0.0;
  Json alarms = Json::array(), probability = Json::array();
  for (const SeenAlarm& alarm : alarms_of(time, replayed)) {
    alarms.push_back({{"begin_s", alarm.begin}, {"end_s", alarm.end}, {"probability", or_null(alarm.probability)}});
  }
  for (const double value : replayed.probability) probability.push_back(or_null(value));
  const Json per_minute = duration > 0.0 ? Json(60.0 * static_cast<double>(alarms.size()) / duration) : Json();
  Json json = {
      {"recording", recording},
      {"trial", trial.record.trial},
      {"object", recorded_object(trial.record.params)},
      {"duration_s", duration},
      {"alarms", std::move(alarms)},
      {"alarms_per_minute", per_minute},
      {"labels", nullptr},
      {"wrong_share", nullptr},
      {"samples",
       {{"time_s", time}, {"state", words_of(replayed.seen)}, {"probability", std::move(probability)}, {"label", nullptr}}}};
  if (const std::optional<LabelRule> rule = rule_of(sensor, simulated)) {
    const Truth truth = trial.truth(*rule);
    const Confusion frames = judged(trial.record.trial, truth, replayed).frames;
    std::size_t judged_samples = 0;
    for (const StateCounts& row : frames) judged_samples = std::accumulate(row.begin(), row.end(), judged_samples);
    json["labels"] = label_rule_name(*rule);
    if (judged_samples > 0) json["wrong_share"] = static_cast<double>(wrong_frames(frames)) / static_cast<double>(judged_samples);
    json["samples"]["label"] = words_of(truth.state);
  }
  return json;
}

// Indices into `trials`, the worst first.
Json worst_of(const Json& trials) {
  const bool labelled = std::ranges::none_of(trials, [](const Json& trial) { return trial.at("wrong_share").is_null(); });
  const char* key = labelled ? "wrong_share" : "alarms_per_minute";
  std::vector<std::size_t> places(trials.size());
  std::iota(places.begin(), places.end(), std::size_t{0});
  const auto badness = [&](std::size_t place) {
    return trials[place].at(key).is_null() ? -1.0 : trials[place].at(key).get<double>();
  };
  std::ranges::stable_sort(places, std::greater{}, badness);
  return places;
}

// Result as UTF-8 text, whatever bytes the file holds.
std::string detected(const DetectOptions& options) {
  const Catalogues catalogues = program_catalogues();
  const LabelRule simulated = learnt_labels(training_of(options.detector));
  Json trials = Json::array(), sensor;
  Notices notices;
  check_given_once(options.recordings, "recording");
  for (const std::string& recording : options.recordings) {
    const DatasetReader reader = whole_dataset(recording);
    for (const std::size_t number : reader.trials()) {
      try {
        const RecordedTrial trial =
            recorded_trial(reader, number, options.detector, options.sensor, catalogues, options.resample);
        notices.add(trial.replayed.notice);
        const SensorRecord& read = trial.sensor();
        if (sensor.is_null()) sensor = {{"name", read.name}, {"type", read.type}, {"rate_hz", read.rate}};
        trials.push_back(detected_trial(recording, trial, simulated));
        trials.back()["sensor"] = read.name;
      } catch (const InputError& error) {
        reject("{}: trial {}: {}", reader.files()[reader.file_of(number)], number, error.what());
      }
    }
  }
  Json json = {{detect_key, 1},
               {"detector", {{"type", options.detector.type}, {"parameters", parameters_json(options.detector.parameters)}}},
               {"sensor", std::move(sensor)},
               {"notice", notices.text()},
               {"worst", worst_of(trials)}};
  if (const std::unique_ptr<network::Engine> network = network_of(options.detector))
    json["reads_hz"] = reads_json(network->description().input);
  json["trials"] = std::move(trials);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A field of CSV.
std::string cell(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  const std::string text = value.get<std::string>();
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string cells_before(const Json& trial) {
  return fmt::format("{},{},{},", cell(trial.at("recording")), cell(trial.at("trial")), cell(trial.at("object")));
}

std::string samples_path(const std::string& path) {
  const std::filesystem::path file(path);
  return (file.parent_path() / (file.stem().string() + "_samples.csv")).string();
}

TextKind csv_kind(const char* head) {
  return {"table of slipbench detect", [head](std::string_view text) { return text.starts_with(head); }};
}

}  // namespace

Json detect(const DetectOptions& options) { return Json::parse(detected(options)); }

std::string alarms_csv(const Json& result) {
  std::string text = alarms_head;
  for (const Json& trial : result.at("trials")) {
    std::size_t number = 0;
    for (const Json& alarm : trial.at("alarms")) {
      text += cells_before(trial) + fmt::format("{},{},{},{}\n", ++number, cell(alarm.at("begin_s")), cell(alarm.at("end_s")),
                                                cell(alarm.at("probability")));
    }
  }
  return text;
}

std::string samples_csv(const Json& result) {
  std::string text = samples_head;
  for (const Json& trial : result.at("trials")) {
    const Json& samples = trial.at("samples");
    const Json& label = samples.at("label");
    const std::string before = cells_before(trial);
    for (std::size_t row = 0; row < samples.at("time_s").size(); ++row) {
      const std::string state = samples.at("state")[row].get<std::string>();
      text += before + fmt::format("{},{},{},{},{}\n", cell(samples.at("time_s")[row]), state,
                                   state == "incipient" || state == "gross" ? 1 : 0, cell(samples.at("probability")[row]),
                                   label.is_null() ? "" : cell(label[row]));
    }
  }
  return text;
}

void check_detect_output(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".csv") {
    check_text_target(path, {}, csv_kind(alarms_head));
    check_text_target(samples_path(path), {}, csv_kind(samples_head));
  } else if (ending == ".json") {
    check_text_target(
        path, {}, {detect_page_kind.json, [](std::string_view text) { return page::begins_as_object(text, detect_page_kind); }});
  } else if (ending == ".html") {
    page::check_page_files(path, detect_page_kind);
  } else if (ending != ".parquet") {
    reject("detect: -o {}: the name ends with {}; allowed: .csv, .json, .html or .parquet", path,
           ending.empty() ? "no extension" : ending);
  }
}

std::vector<std::string> write_detection(const std::string& path, const Json& result) {
  check_detect_output(path);
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending == ".html") return page::write_page_files(path, detect_page_kind, detect_page(result), result);
  if (ending == ".json") {
    write_text_file(path, result.dump(1) + "\n");
    return {path};
  }
  write_text_files({{path, alarms_csv(result)}, {samples_path(path), samples_csv(result)}});
  return {path, samples_path(path)};
}

}  // namespace slipbench::eval
