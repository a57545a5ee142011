#include "tools/program/sweep/sweep_json.h"

#include <algorithm>
#include <utility>

#include "tools/base/dataset/header.h"
#include "tools/base/record/json.h"
#include "tools/program/catalogue/detector_catalogue.h"

namespace slipbench {
namespace {

// One number of every unit; nlohmann writes NaN as null.
template <class Number>
Json column(const std::vector<UnitOutcome>& units, Number UnitOutcome::*member) {
  Json values = Json::array();
  for (const UnitOutcome& unit : units) values.push_back(unit.*member);
  return values;
}

void add_trial(DetectorScore& score, const TrialOutcome& outcome, const Confusion& confusion) {
  ++score.trials;
  add(score.confusion, confusion);
  switch (outcome.detection.value()) {
    case Detection::quiet: return;
    case Detection::false_alarm: ++score.false_alarms; return;
    case Detection::early: ++score.early; break;
    case Detection::seen: score.delays.push_back(outcome.detection_delay); break;
    case Detection::missed: ++score.missed; break;
  }
  ++score.slipping;
}

}  // namespace

std::string trial_json(const TrialSummary& trial) {
  Json sensors = Json::object();
  for (const SensorSummary& sensor : trial.sensors) {
    if (trial.resumed) break;
    sensors[sensor.name] = {{"touch_time_s", column(sensor.units, &UnitOutcome::touch_time)},
                            {"onset_time_s", column(sensor.units, &UnitOutcome::onset_time)},
                            {"micro_onset_time_s", column(sensor.units, &UnitOutcome::micro_onset_time)},
                            {"slip_distance_m", column(sensor.units, &UnitOutcome::slip_distance)},
                            {"load_N", column(sensor.units, &UnitOutcome::load)},
                            {"margin", column(sensor.units, &UnitOutcome::margin)},
                            {"state_count", sensor.state_count},
                            {"state_micro_count", sensor.state_micro_count}};
  }
  Json json = {{"trial", trial.trial},
               {"params", Json::parse(trial.params)},
               {"outcome", Json::parse(outcome_json(trial.outcome))},
               {"sensors", std::move(sensors)}};
  if (trial.detector) {
    json["detector"] = {{"type", trial.detector->type},
                        {"oracle", trial.detector->type == oracle_type},
                        {"sensor", trial.detector->sensor},
                        {"recall_of_slip", recall_of_slip(trial.detector->confusion)},
                        {"balanced_accuracy", balanced_accuracy(trial.detector->confusion)},
                        {"constant_balanced_accuracy", constant_balanced_accuracy(trial.detector->confusion)},
                        {"accuracy", accuracy(trial.detector->confusion)},
                        {"constant_accuracy", constant_accuracy(trial.detector->confusion)},
                        {"confusion", trial.detector->confusion}};
  }
  if (!trial.controller.empty()) json["controller"] = trial.controller;
  if (trial.resumed) json["resumed"] = true;
  return json.dump();
}

std::string summary_json(const SweepSummary& summary) {
  Json failed = Json::array();
  for (const FailedTrial& trial : summary.failed) {
    failed.push_back({{"trial", trial.trial}, {"message", trial.message}, {"command", trial.command}});
  }
  Json json = {{"command", summary.command},
               {"seed", summary.seed},
               {"planned", summary.planned},
               {"finished", summary.was_complete ? summary.resumed : summary.trials.size()},
               {"resumed", summary.resumed},
               {"failed", std::move(failed)},
               {"simulated_s", summary.simulated},
               {"interrupted", summary.interrupted},
               {"files", summary.files}};
  if (summary.shard) json["shard"] = shard_text(*summary.shard);
  return json.dump();
}

std::vector<DetectorScore> detector_scores(const std::vector<TrialSummary>& trials) {
  std::vector<DetectorScore> scores;
  for (const TrialSummary& trial : trials) {
    if (!trial.detector) continue;
    auto score = std::ranges::find(scores, trial.detector->type, &DetectorScore::type);
    if (score == scores.end()) score = scores.insert(scores.end(), DetectorScore{.type = trial.detector->type, .delays = {}});
    add_trial(*score, trial.outcome, trial.detector->confusion);
  }
  return scores;
}

}  // namespace slipbench
