#include "tools/program/report/report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "sim/core/detector.h"
#include "sim/core/error.h"
#include "sim/scene/parser.h"
#include "tools/base/dataset/content_check.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/output_file.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/page/json.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/report/assumptions.h"
#include "tools/program/report/report_grasp.h"
#include "tools/program/report/report_page.h"
#include "tools/program/report/report_parameters.h"
#include "tools/program/report/report_summary.h"
#include "tools/program/report/report_trial.h"
#include "tools/program/run/warnings.h"

namespace slipbench {

namespace {

// Curve values embedded in all, so that the page stays below some 6 MB: six 4 s trials of nine pillars at 1 kHz fit in full.
constexpr std::size_t curve_values_in_page = 4'000'000;

constexpr std::size_t trials_in_page = 6;

// A trial of a grasp is small, 18 kB where 9 pillars are sampled at 100 Hz for 5 s, and every one of a set of trials is worth a
// look.
constexpr std::size_t grasps_in_page = 300;
constexpr std::size_t curve_values_of_grasp = 100'000;

// The trials whose curves go into the page: the one asked for and others at equal distances over the file.
std::vector<std::size_t> embedded_trials(const std::vector<std::size_t>& trials, const ReportOptions& options, bool grasps) {
  const std::size_t count = std::min(options.max_trials.value_or(grasps ? grasps_in_page : trials_in_page), trials.size());
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(trials[count == 1 ? 0 : i * (trials.size() - 1) / (count - 1)]);
  }
  if (options.trial && std::find(chosen.begin(), chosen.end(), *options.trial) == chosen.end()) {
    // It takes the place of the nearest one.
    const auto distance = [&](std::size_t trial) {
      return trial > *options.trial ? trial - *options.trial : *options.trial - trial;
    };
    *std::min_element(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); }) =
        *options.trial;
  }
  return chosen;
}

Json parse_json(const std::string& text, const std::string& subject) {
  Json value = Json::parse(text, nullptr, false);
  if (value.is_discarded()) throw InputError(subject + " is not JSON: " + text.substr(0, 60));
  return value;
}

std::string description_of(const std::string& scene, const std::string& subject) {
  try {
    const YAML::Node description = YAML::Load(scene)["description"];
    return description ? description.as<std::string>() : "";
  } catch (const YAML::Exception& error) {
    throw InputError(subject + " is not a scene: " + error.what());
  }
}

// Drawn parameters of a trial: {path: plain value}, those that it has.
Json drawn_parameters(const std::string& params, const std::string& subject) {
  const Json stored = parse_json(params, subject);
  if (!stored.is_object()) throw InputError(subject + " is not a JSON object");
  Json result = Json::object();
  for (const auto& [path, value] : stored.items()) {
    if (!value.is_null()) result[path] = report::plain_value(path, value);  // null: a parameter of another type than the trial's
  }
  return result;
}

// One row of the overview; with `curve_values` above 0 the trial's curves are added to `curves`, and those of a grasp to
// `grasps`.
Json trial_row(const TrialRecord& record, const std::string& file, std::size_t curve_values, Json& curves, Json& grasps) {
  const std::string subject = file + ": /data/demo_" + std::to_string(record.trial);
  Json row = {{"index", record.trial},
              {"seed", std::to_string(record.seed)},
              {"samples", record.num_samples()},
              {"params", drawn_parameters(record.params, subject + ": attribute params")},
              {"sensors", Json::object()}};
  double first_touch = std::numeric_limits<double>::infinity();
  for (const SensorRecord& sensor : record.sensors) {
    report::check_labels(sensor, subject);
    for (const double time : report::touch_times(sensor.labels)) first_touch = std::fmin(first_touch, time);
    row["sensors"][sensor.name] = report::summarise(sensor);
    if (curve_values > 0) {
      curves[std::to_string(record.trial)].push_back(
          report::trial_payload(sensor, record.control ? &*record.control : nullptr, curve_values / record.sensors.size()));
    }
  }
  if (record.control && !record.control->controller.empty()) row["controller"] = record.control->controller;
  if (record.control && !record.control->detector.empty()) {
    row["detector"] = {{"type", record.control->detector},
                       {"oracle", record.control->detector == oracle_type},
                       {"sensor", record.control->sensor},
                       {"confusion", record.control->confusion},
                       {"detection", detection_word(record.outcome.detection.value())},
                       {"detection_s", report::number_or_null(record.outcome.detection_time)},
                       {"delay_s", report::number_or_null(record.outcome.detection_delay)},
                       {"false_alarm_s", report::number_or_null(record.outcome.false_alarm_time)}};
  }
  if (!record.outcome.saturated.empty()) row["saturated"] = record.outcome.saturated;
  if (record.outcome.grasp) {
    row["grasp"] = report::grasp_summary(*record.outcome.grasp);
    if (curve_values > 0 && !record.sensors.empty())
      grasps[std::to_string(record.trial)] = report::grasp_payload(record, curve_values, subject);
  }
  row["motion_start_s"] =
      report::number_or_null(record.outcome.grasp ? report::lift_time(record) : report::motion_start(record, first_touch));
  return row;
}

// What the scene warns of, as far as this version can read it; nothing is built, since that would open files that the dataset
// names.
std::vector<Warning> warnings_of(const DatasetHeader& header, const Json& overrides, const std::vector<std::size_t>& trials) {
  try {
    SceneFile file = SceneFile::from_text(header.scene, "scene");
    for (const auto& [path, value] : overrides.items()) {
      if (!value.is_string()) throw InputError("overrides hold no text for " + path);
      file.apply({path, value.get<std::string>()});
    }
    const Catalogues catalogues = program_catalogues();
    const TrialPlan plan(file, catalogues, 0, header.seed);
    std::vector<std::size_t> own = trials;  // --trials may have made more
    std::erase_if(own, [&](std::size_t trial) { return trial >= plan.size(); });
    std::vector<Warning> warnings = scene_warnings(plan, own, false);
    std::ranges::move(split_warnings(plan, own), std::back_inserter(warnings));
    return warnings;
  } catch (const InputError& error) {
    return {{"scene", std::string("this version of slipbench cannot look at the scene: ") + error.what()}};
  }
}

// The trials in the overview, ascending: `embedded`, and others at equal distances.
std::vector<std::size_t> rows_of(const std::vector<std::size_t>& trials, const std::vector<std::size_t>& embedded,
                                 std::size_t most) {
  std::set<std::size_t> chosen(embedded.begin(), embedded.end());
  const std::size_t count = std::min(most, trials.size());
  for (std::size_t i = 0; i < count; ++i) chosen.insert(trials[i * trials.size() / count]);
  return {chosen.begin(), chosen.end()};
}

// The page of a dataset.
std::string page_of(const std::string& dataset_path, const ReportOptions& options) {
  const DatasetReader dataset(dataset_path);
  dataset.check_truth("a report",
                      "a dataset that slipbench has simulated; `slipbench export --format csv` writes tables of this one");
  const std::vector<std::size_t>& trials = dataset.trials();
  if (trials.empty()) throw InputError(dataset_path + ": holds no trial, so there is nothing to report");
  if (options.trial && !std::binary_search(trials.begin(), trials.end(), *options.trial)) {
    throw InputError(dataset_path + ": there is no trial " + std::to_string(*options.trial) +
                     "; allowed: " + std::to_string(trials.front()) + " to " + std::to_string(trials.back()));
  }
  if (options.trial) dataset.check_recorded(*options.trial);
  const bool of_grasps = parse_outcome(dataset.info(trials.front()).outcome).grasp.has_value();
  const std::vector<std::size_t> embedded = embedded_trials(trials, options, of_grasps);
  const std::vector<std::size_t> shown = rows_of(trials, embedded, options.max_rows);
  const std::size_t curve_values =
      std::max(curve_values_in_page / embedded.size(), of_grasps ? curve_values_of_grasp : std::size_t{0});

  const DatasetHeader& header = dataset.header();
  Json page = {{"file", std::filesystem::path(dataset_path).filename().string()},
               {"description", description_of(header.scene, dataset_path + ": attribute scene")},
               {"version", header.version},
               {"command", header.command},
               {"seed", std::to_string(header.seed)},
               {"scene", header.scene},
               {"overrides", parse_json(header.overrides, dataset_path + ": attribute overrides")},
               {"content_sha256", dataset.content_sha256()},
               {"trials_in_file", trials.size()},
               {"complete", dataset.complete()},
               {"failed", Json::parse(failures_json(dataset.failed()))},
               {"open", options.trial ? Json(*options.trial) : Json(nullptr)}};

  Json rows = Json::array();
  Json curves = Json::object();
  Json grasps = Json::object();
  Json types = Json::object();
  std::vector<Json> drawn;
  std::map<std::string, ConverterUse> converters;
  ContentCheck check(dataset);
  for (const std::size_t trial : trials) {
    check.add(trial);
    if (!std::ranges::binary_search(shown, trial)) continue;
    const bool embed = std::find(embedded.begin(), embedded.end(), trial) != embedded.end();
    const TrialRecord record = dataset.read_trial(trial);
    rows.push_back(trial_row(record, dataset_path, embed ? curve_values : 0, curves, grasps));
    drawn.push_back(rows.back()["params"]);
    count_converters(record, converters);
    for (const SensorRecord& sensor : record.sensors) types[sensor.type] = report::view_payload(sensor.type);
  }
  check.finish();
  std::vector<Warning> warnings = warnings_of(header, page["overrides"], trials);
  if (shown.size() < trials.size()) {
    warnings.push_back(
        {"trials",
         fmt::format("this page is made of {} of the dataset's {} trials, spread evenly: all that it counts is of these",
                     shown.size(), trials.size())});
  }
  std::ranges::move(converter_warnings(converters), std::back_inserter(warnings));
  page["warnings"] = warnings_json(warnings);
  page["trials"] = std::move(rows);
  page["curves"] = std::move(curves);
  page["sensor_types"] = std::move(types);
  page["axes"] = report::axes(drawn);
  if (!grasps.empty()) page["grasps"] = std::move(grasps);
  if (of_grasps) {
    page["grasp_parameters"] =
        report::grasp_parameters(header.scene, page["overrides"], drawn.front(), dataset_path + ": attribute scene");
  }

  const auto description = page["description"].get<std::string>();
  return report::report_page(description.empty() ? page["file"].get<std::string>() : description, page);
}

}  // namespace

void check_report_target(const std::string& html_path, const std::string& dataset_path) {
  check_text_target(html_path, {dataset_path}, {"report", &report::begins_as_report});
}

void write_report(const std::string& dataset_path, const std::string& html_path, const ReportOptions& options) {
  if (options.max_trials == std::size_t{0}) throw std::logic_error("a report embeds at least one trial");
  check_report_target(html_path, dataset_path);
  write_text_file(html_path, guarded(dataset_path, [&] { return page_of(dataset_path, options); }));
}

}  // namespace slipbench
