#include "tools/report/report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "sim/api/detector.h"
#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/effects/install.h"
#include "sim/effects/skin/influence.h"
#include "sim/scene/parser.h"
#include "sim/scene/scene_reader.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/files/output_file.h"
#include "tools/learning_data/label_rules.h"
#include "tools/registry/program_catalogues.h"
#include "tools/report/page_budget.h"
#include "tools/report/report_grasp.h"
#include "tools/report/report_recordings.h"
#include "tools/report/report_summary.h"
#include "tools/report/report_trial.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/sweep/warnings.h"

namespace slipbench {
namespace {

constexpr std::string_view generator = "slipbench";
constexpr const char* title_end = " · slipbench report";

// Packed curves of one trial.
struct TrialCurves {
  Json sensors = Json::array();
  Json grasp = nullptr;

  [[nodiscard]] std::size_t bytes() const { return sensors.dump().size() + (grasp.is_null() ? 0 : grasp.dump().size()); }
  // Number of values per curve row of the largest sensor.
  [[nodiscard]] std::size_t columns() const {
    std::size_t most = 0;
    for (const Json& sensor : sensors) {
      std::size_t sum = 0;
      for (const Json& curve : sensor.at("curves")) sum += curve.at("data").at("columns").get<std::size_t>();
      most = std::max(most, sum);
    }
    return most;
  }
};

TrialCurves curves_of(const TrialRecord& record, std::size_t values, const std::string& subject) {
  TrialCurves curves;
  for (const SensorRecord& sensor : record.sensors) {
    curves.sensors.push_back(
        report::trial_payload(sensor, record.control ? &*record.control : nullptr, values / record.sensors.size()));
  }
  if (record.outcome.grasp && !record.sensors.empty()) curves.grasp = report::grasp_payload(record, values, subject);
  return curves;
}

// The budget of a page with these trials. `first`: a representative one; `trials`: number of those
// that may have curves; `row_bytes`: size of the overview's rows.
report::PageBudget budget_of(const TrialRecord& first, const std::string& subject, std::size_t trials, std::size_t row_bytes) {
  if (first.sensors.empty()) return {};
  const std::size_t columns = curves_of(first, report::most_curve_values, subject).columns() * first.sensors.size();
  const report::CurveRange range = report::curve_range(columns, first.num_samples());
  return {range, curves_of(first, range.coarsest, subject).bytes(), trials, row_bytes};
}

// Curves as fine as the budget allows.
TrialCurves fitted_curves(const TrialRecord& record, const std::string& subject, report::PageBudget& budget) {
  while (true) {
    TrialCurves curves = curves_of(record, budget.curve_values(), subject);
    if (budget.accept(curves.bytes())) return curves;
  }
}

std::string description_of(const std::string& scene, const std::string& subject) {
  try {
    const YAML::Node description = YAML::Load(scene)["description"];
    return description ? description.as<std::string>() : "";
  } catch (const YAML::Exception& error) {
    throw InputError(subject + " is not a scene: " + error.what());
  }
}

// Drawn parameters of a trial: {path: plain value}.
Json drawn_parameters(const std::string& params, const std::string& subject) {
  Json result = Json::object();
  const Json stored = json_object(params, subject);
  for (const auto& [path, value] : stored.items()) {
    if (!value.is_null()) result[path] = report::plain_value(path, value);  // null: parameter of another type than the trial's
  }
  return result;
}

std::string subject_of(const std::string& file, std::size_t trial) { return file + ": /data/demo_" + std::to_string(trial); }

// One row of the overview.
Json trial_row(const TrialRecord& record, const std::string& subject) {
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
  }
  if (record.control && !record.control->controller.empty()) row["controller"] = record.control->controller;
  if (record.control && !record.control->detector.empty()) {
    row["detector"] = {{"type", record.control->detector},
                       {"oracle", record.control->detector == oracle_type},
                       {"sensor", record.control->sensor},
                       {"confusion", record.control->confusion},
                       {"detection", detection_word(record.outcome.detection.value())},
                       {"detection_s", or_null(record.outcome.detection_time)},
                       {"delay_s", or_null(record.outcome.detection_delay)},
                       {"false_alarm_s", or_null(record.outcome.false_alarm_time)}};
  }
  if (!record.outcome.saturated.empty()) row["saturated"] = record.outcome.saturated;
  if (record.outcome.grasp) row["grasp"] = report::grasp_summary(*record.outcome.grasp);
  row["motion_start_s"] = or_null(record.outcome.grasp ? report::lift_time(record) : report::motion_start(record, first_touch));
  return row;
}

// Parameters for the closed form of a pad that is one elastic body; null for other pads.
Json skin_of(const Scene& scene) {
  const auto is_body = [](const Named& effect) { return effect_kind(effect.name).body != nullptr; };
  const auto skin = std::ranges::find_if(scene.effects, is_body);
  if (skin == scene.effects.end()) return nullptr;
  const ElasticBody body = effect_kind(skin->name).body(skin->parameters);
  const bool sphere = scene.surface.name == "sphere" && std::isinf(body.thickness);
  Json sensors = Json::array();  // a sensor with its own friction has no effects
  for (const SensorScene& sensor : scene.sensors) {
    if (!sensor.friction) sensors.push_back(sensor.name);
  }
  return {{"sensors", sensors},
          {"shear_modulus", body.shear_modulus},
          {"friction", scene.friction.static_coefficient},
          {"sphere_radius", sphere ? Json(scene.surface.parameters.number("radius")) : Json(nullptr)}};
}

// Reason why no command line can run the trials again: the scene names types that a Python program
// registered, or is of another version. Null if one can.
Json no_replay(const DatasetHeader& header, const Json& overrides, std::size_t trial) {
  try {
    const Catalogues catalogues = command_line_catalogues();  // the plan refers to it
    const TrialPlan plan{recorded_file(header.scene, overrides, "scene"), catalogues, 0, header.seed};
    if (trial < plan.size()) static_cast<void>(plan.trial(trial));
    return nullptr;
  } catch (const InputError& error) {
    return error.what();
  }
}

// Returns the scene's warnings, and adds data of soft skins of the trials `embedded` to the page,
// if this version can read the scene.
std::vector<Warning> read_scene(const DatasetHeader& header, const std::vector<std::size_t>& trials,
                                const std::vector<std::size_t>& embedded, Json& page) {
  try {
    const Catalogues catalogues = program_catalogues();
    // Nothing is built, since that would open files named by the dataset.
    const TrialPlan plan{recorded_file(header.scene, page["overrides"], "scene"), catalogues, 0, header.seed};
    std::vector<std::size_t> own = trials;  // --trials may have added more
    std::erase_if(own, [&](std::size_t trial) { return trial >= plan.size(); });
    for (const std::size_t trial : embedded) {
      if (trial >= plan.size()) continue;
      if (const Json skin = skin_of(plan.trial(trial).scene); !skin.is_null()) page["skins"][std::to_string(trial)] = skin;
    }
    std::vector<Warning> warnings = scene_warnings(plan, own, false);
    std::ranges::move(split_warnings(plan, own), std::back_inserter(warnings));
    return warnings;
  } catch (const InputError& error) {
    return {{"scene",
             std::string("the page shows no warnings about the scene, because this program does not know all of its parts: ") +
                 error.what()}};
  }
}

// Throws InputError for a dataset without trials, and for a trial that it does not have.
void check_reportable(const DatasetReader& dataset, const std::string& path, const std::optional<std::size_t>& trial) {
  const std::vector<std::size_t>& trials = dataset.trials();
  if (trials.empty()) throw InputError(path + ": contains no trial");
  if (!trial) return;
  if (!std::binary_search(trials.begin(), trials.end(), *trial)) {
    throw InputError(path + ": no trial " + std::to_string(*trial) + "; allowed: " + std::to_string(trials.front()) + " to " +
                     std::to_string(trials.back()));
  }
  dataset.check_recorded(*trial);
}

// The rules of the states that the page shows.
Json rules_json() {
  Json rules = Json::array();
  for (const LabelRule rule : {LabelRule::strict, LabelRule::micro, LabelRule::paper}) {
    const LabelRuleInfo& about = about_rule(rule);
    rules.push_back({{"key", about.name}, {"name", about.name}, {"note", about.meaning}});
  }
  return rules;
}

// Page data about the dataset as a whole.
Json head_of(const DatasetReader& dataset, const std::string& path, const ReportOptions& options) {
  const DatasetHeader& header = dataset.header();
  return {{"file", std::filesystem::path(path).filename().string()},
          {"description", description_of(header.scene, path + ": attribute scene")},
          {"version", header.version},
          {"command", header.command},
          {"seed", std::to_string(header.seed)},
          {"scene", header.scene},
          {"overrides", json_object(header.overrides, path + ": attribute overrides")},
          {"content_sha256", dataset.content_sha256()},
          {"trials_in_file", dataset.trials().size()},
          {"recorded", Json::array()},
          {"complete", dataset.complete()},
          {"failed", Json::parse(failures_json(dataset.failed()))},
          {"open", or_null(options.trial)}};
}

// Data collected trial by trial.
struct Gathered {
  Json rows = Json::array(), types = Json::object();
  std::vector<std::pair<std::string, Json>> recordings;
  std::vector<Json> drawn;
  std::map<std::string, ConverterUse> converters;
};

// Reads the trials `shown`, with curves of those in `embedded`. Marks in `page` which are recorded.
Gathered gather(const DatasetReader& dataset, const std::string& path, const ReportOptions& options, report::PageBudget& budget,
                const std::vector<std::size_t>& shown, const std::vector<std::size_t>& embedded, Json& page) {
  Gathered gathered;
  for (const std::size_t trial : dataset.trials()) {
    if (!std::ranges::binary_search(shown, trial)) continue;
    end_if_interrupted();
    const TrialRecord record = dataset.read_trial(trial);
    const std::string subject = subject_of(path, trial);
    gathered.rows.push_back(trial_row(record, subject));
    if (!record.sensors.empty() && std::ranges::find(embedded, trial) != embedded.end()) {
      TrialCurves own =
          trial == options.trial ? curves_of(record, report::most_curve_values, subject) : fitted_curves(record, subject, budget);
      page["recorded"].push_back(trial);
      if (!own.grasp.is_null()) page["grasps"] = true;
      gathered.recordings.emplace_back("recording-" + std::to_string(trial),
                                       Json{{"sensors", std::move(own.sensors)}, {"grasp", std::move(own.grasp)}});
    }
    gathered.drawn.push_back(gathered.rows.back()["params"]);
    count_converters(record, gathered.converters);
    for (const SensorRecord& sensor : record.sensors) gathered.types[sensor.type] = report::view_payload(sensor.type);
  }
  return gathered;
}

// The page of a dataset.
std::string page_of(const std::string& dataset_path, const ReportOptions& options) {
  const DatasetReader dataset = checked_dataset(dataset_path);
  check_reportable(dataset, dataset_path, options.trial);
  const std::string file = std::filesystem::path(dataset_path).filename().string();
  if (!dataset.header().truth.empty())
    return page::compose_page({generator, file + title_end}, report::recordings_body(dataset, file, options));
  const std::vector<std::size_t>& trials = dataset.trials();
  const TrialRecord first = dataset.read_trial(trials.front());
  const bool of_grasps = first.outcome.grasp.has_value();
  const std::string first_subject = subject_of(dataset_path, trials.front());
  report::PageBudget budget =
      budget_of(first, first_subject, std::min(trials.size(), options.max_trials.value_or(trials.size())),
                trial_row(first, first_subject).dump().size() * std::min(trials.size(), options.max_rows));
  const std::vector<std::size_t> embedded = report::trials_with_curves(trials, budget.count(), options.trial);
  const std::vector<std::size_t> shown = report::trials_with_rows(trials, embedded, options.max_rows);

  Json page = head_of(dataset, dataset_path, options);
  Gathered gathered = gather(dataset, dataset_path, options, budget, shown, embedded, page);
  std::vector<Warning> warnings = read_scene(dataset.header(), trials, embedded, page);
  page["no_replay"] = no_replay(dataset.header(), page["overrides"], trials.front());
  if (shown.size() < trials.size()) {
    warnings.push_back(
        {"trials",
         fmt::format("this page uses {} of the {} trials of the dataset, evenly spread; all its numbers refer to these trials",
                     shown.size(), trials.size())});
  }
  std::ranges::move(converter_warnings(gathered.converters), std::back_inserter(warnings));
  page["warnings"] = warnings_json(warnings);
  page["trials"] = std::move(gathered.rows);
  page["sensor_types"] = std::move(gathered.types);
  page["rules"] = rules_json();
  page["axes"] = report::axes(gathered.drawn);
  if (of_grasps) {
    page["grasp_parameters"] = report::grasp_parameters(dataset.header().scene, page["overrides"], gathered.drawn.front(),
                                                        dataset_path + ": attribute scene");
  }

  const auto description = page["description"].get<std::string>();
  return report::report_page(description.empty() ? page["file"].get<std::string>() : description, page, gathered.recordings);
}

}  // namespace

std::string report::report_page(const std::string& title, const Json& data,
                                const std::vector<std::pair<std::string, Json>>& recordings) {
  std::vector<page::Asset> files = assets();
  const auto leave_out = [&](std::string_view prefix) {
    std::erase_if(files, [&](const page::Asset& file) { return file.name.starts_with(prefix); });
  };
  if (!data.contains("grasps")) leave_out("grasp_");
  if (!data.contains("skins")) leave_out("skin.");
  return page::compose_drawn_page({generator, title + title_end}, files, data, recordings);
}

bool report::begins_as_report(std::string_view text) { return page::begins_as_page(text, generator); }

void check_report_target(const std::string& html_path, const std::string& dataset_path) {
  check_text_target(html_path, {dataset_path}, {"report", &report::begins_as_report});
}

void write_report(const std::string& dataset_path, const std::string& html_path, const ReportOptions& options) {
  if (options.max_trials == std::size_t{0}) throw std::logic_error("a report embeds at least one trial");
  check_report_target(html_path, dataset_path);
  write_text_file(html_path, page_of(dataset_path, options));
}

std::string report_path(const std::string& dataset_path) {
  return std::filesystem::path(dataset_path).replace_extension(".html").string();
}

}  // namespace slipbench
