#include "tools/eval/evaluate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "detectors/detector_kinds.h"
#include "detectors/hd/memory_files.h"
#include "sim/core/counted.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/encoder.h"
#include "tools/eval/recorded_trial.h"
#include "tools/eval/replay.h"
#include "tools/eval/yardsticks.h"
#include "tools/files/reject.h"
#include "tools/page/timeline.h"
#include "tools/registry/program_catalogues.h"
#include "tools/statistics/descriptive.h"

namespace slipbench::eval {
namespace {

constexpr std::size_t most_groups = 24, roc_points = 400, calibration_parts = 10, worst_of_a_kind = 4;
constexpr std::array<const char*, 3> masks{"train", "valid", "test"};

// Properties of a trial besides its samples.
struct Facts {
  std::string material, object, mask;
  std::string named;                                           // class of the trial in the recordings' own set; empty: none
  double speed = std::numeric_limits<double>::quiet_NaN();     // m/s, commanded, of the outermost unit
  double friction = std::numeric_limits<double>::quiet_NaN();  // static, mean over the units
};

// One trial with its results.
struct Judged {
  Judgement judgement;
  Facts facts;
  std::optional<bool>
      as_in_loop;  // true if the dataset's own detector gave the same classes; empty: it read another sensor, or there is no detector
  std::string loop_detector;
  std::optional<GraspOutcome> grasp;
  std::vector<Judgement> at;       // for each of alarm_thresholds(); empty: no probability
  std::vector<std::size_t> named;  // number of samples by the class that a network chooses
  Json sensor;                     // name, type, rate
  double origin = 0.0;             // s, page::time_origin()
  std::string notice;              // of the detector
};

// Thresholds of a probability, from almost everything called slip to almost nothing.
std::vector<double> alarm_thresholds() {
  std::vector<double> thresholds;
  for (double logit = -4.0; logit <= 7.0; logit += 0.5) thresholds.push_back(1.0 / (1.0 + math::exp(-logit)));
  return thresholds;
}

// Result with another threshold. `replayed`: the detector's probabilities.
Replayed with_threshold(const Replayed& replayed, const network::Alarm& alarm, double threshold) {
  Replayed other = replayed;
  network::AlarmGate gate(alarm);
  PadState state = PadState::no_contact;
  for (std::size_t row = 0; row < replayed.seen.size(); ++row) {
    if (!std::isnan(replayed.probability[row]))
      state = gate.push(replayed.probability[row] >= threshold) ? PadState::gross : PadState::non_slip;
    other.seen[row] = state;
  }
  std::ranges::fill(other.probability, std::numeric_limits<double>::quiet_NaN());
  return other;
}

// Swept values that identify the touched object.
std::string object_of(const std::string& params) {
  const Json swept = Json::parse(params, nullptr, false);
  std::string object;
  if (!swept.is_object()) return object;
  for (const auto& [path, value] : swept.items()) {
    const bool of_object = path == "object" || path.starts_with("surface.") || path.starts_with("box.") ||
                           path.starts_with("bodies.") || path == "model";
    if (of_object)
      object += (object.empty() ? "" : ", ") + path + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return object;
}

// Distance of the outermost unit from the pad's centre [m], which rotation moves fastest.
double reach_of(const LabelRecord& labels) {
  double reach = 0.0;
  for (std::size_t k = 0; k + 1 < labels.unit_positions.size(); k += 2) {
    reach = std::max(reach, math::hypot(labels.unit_positions[k], labels.unit_positions[k + 1]));
  }
  return reach;
}

// A parameter of the scene's motion; 0 if it has none of that name.
double of_motion(const Scene& scene, const char* name) {
  const auto& values = scene.motion.parameters.values();
  const auto found = values.find(name);
  return found != values.end() && std::holds_alternative<double>(found->second) ? std::abs(std::get<double>(found->second)) : 0.0;
}

// `scene`: null for an imported trial.
Facts facts_of(const Scene* scene, const TrialRecord& record, const SensorRecord& sensor) {
  Facts facts;
  facts.object = object_of(record.params);
  const Json swept = Json::parse(record.params, nullptr, false);
  if (swept.is_object() && swept.contains("class") && swept.at("class").is_string()) facts.named = swept.at("class");
  const std::vector<double>& friction = sensor.labels.mu_static;
  if (!friction.empty()) facts.friction = mean_sd(friction).mean;
  if (scene == nullptr) return facts;
  facts.material = scene->material;
  if (scene->motion.parameters.values().contains("speed")) {
    facts.speed = std::max(of_motion(*scene, "speed"), reach_of(sensor.labels) * of_motion(*scene, "rotation"));
  }
  return facts;
}

Judged judged_trial(const DatasetReader& reader, std::size_t trial, const Options& options, LabelRule labels,
                    const Catalogues& catalogues, const network::Alarm& alarm, YardstickScores& yardsticks) {
  const RecordedTrial recorded = recorded_trial(reader, trial, options.detector, options.sensor, catalogues, options.resample);
  const TrialRecord& record = recorded.record;
  const SensorRecord& sensor = recorded.sensor();
  const Replayed& replayed = recorded.replayed;
  Judged result;
  const Truth truth = recorded.truth(labels);
  result.judgement = judged(trial, truth, replayed);
  if (!result.judgement.positives.empty() || !result.judgement.negatives.empty()) {
    for (const double threshold : alarm_thresholds())
      result.at.push_back(judged(trial, truth, with_threshold(replayed, alarm, threshold)));
  }
  for (const double number : replayed.named) {
    if (std::isnan(number)) continue;
    result.named.resize(std::max(result.named.size(), static_cast<std::size_t>(number) + 1));
    ++result.named[static_cast<std::size_t>(number)];
  }
  result.judgement.twin = truth_sha256(sensor.labels);
  result.facts = facts_of(recorded.scene ? &*recorded.scene : nullptr, record, sensor);
  yardsticks.add(recorded, truth, result.judgement.twin, recorded.scene ? "" : result.facts.object, options.resample);
  result.grasp = record.outcome.grasp;
  result.origin = page::time_origin(sensor.time);
  result.notice = replayed.notice;
  result.sensor = {{"name", sensor.name}, {"type", sensor.type}, {"rate_hz", sensor.rate}};
  if (record.control && !record.control->detector.empty() && record.control->sensor == sensor.name) {
    result.loop_detector = record.control->detector;
    const auto same = [](std::uint8_t one, PadState other) { return one == static_cast<std::uint8_t>(other); };
    result.as_in_loop = std::ranges::equal(record.control->detector_class, replayed.seen, same);
  }
  return result;
}

// Group of a trial in a breakdown, with its sorting key.
struct Group {
  double order = 0.0;
  std::string name;  // empty: unknown

  friend bool operator<(const Group& a, const Group& b) { return std::tie(a.order, a.name) < std::tie(b.order, b.name); }
};
using Key = std::function<Group(const Judged&)>;

// Octave of a speed, named by its range in mm/s.
Group octave_of(double speed) {
  if (std::isnan(speed)) return {};
  if (!(speed > 0.0)) return {0.0, "at rest"};
  // A nominal 16 mm/s may be a few units in the last place below 16.
  constexpr double rounding = 1.0 + 1e-12;
  const double low = std::ldexp(1.0, std::ilogb(1e3 * speed * rounding));
  return {low, fmt::format("{:g} to {:g} mm/s", low, 2.0 * low)};
}

// Summaries by a key; empty if a trial has no group, or the groups are too few or too many.
Json broken_down(const std::vector<Judged>& trials, const Key& key) {
  std::map<Group, std::vector<Judgement>> groups;
  for (const Judged& trial : trials) {
    const Group group = key(trial);
    if (group.name.empty()) return {};
    if (!trial.judgement.labelled) continue;
    groups[group].push_back(trial.judgement);
  }
  if (groups.size() < 2 || groups.size() > most_groups) return {};
  Json json = Json::array();
  for (const auto& [about, members] : groups) {
    Json group = {{"name", about.name}};
    group.update(summary_json(summarised(members)));
    json.push_back(std::move(group));
  }
  return json;
}

// `untouched`: the detector was trained on no trial of the dataset. Otherwise the dataset's masks
// do not show which trials are new to it.
Json breakdowns(const std::vector<Judged>& trials, bool untouched) {
  Json json = Json::array();
  const auto add = [&](const char* by, const Key& key) {
    Json groups = broken_down(trials, key);
    if (!groups.is_null()) json.push_back({{"by", by}, {"groups", std::move(groups)}});
  };
  add("material", [](const Judged& trial) { return Group{0.0, trial.facts.material}; });
  add("object", [](const Judged& trial) {
    const bool is_material = trial.facts.object == "surface.material " + trial.facts.material;
    return Group{0.0, is_material ? "" : trial.facts.object};
  });
  add("speed", [](const Judged& trial) { return octave_of(trial.facts.speed); });
  if (!untouched) return json;
  add("mask", [](const Judged& trial) {
    const auto place = std::ranges::find(masks, trial.facts.mask);
    return Group{static_cast<double>(place - masks.begin()), trial.facts.mask};
  });
  return json;
}

// Adds `roc` and `calibration`.
void add_curves(Json& json, const std::vector<Judged>& trials) {
  std::vector<double> positives, negatives;
  for (const Judged& trial : trials) {
    positives.insert(positives.end(), trial.judgement.positives.begin(), trial.judgement.positives.end());
    negatives.insert(negatives.end(), trial.judgement.negatives.begin(), trial.judgement.negatives.end());
  }
  if (positives.empty() || negatives.empty()) return;
  json["roc"] = Json::array();
  for (const RocPoint& point : roc_curve(positives, negatives, roc_points)) {
    json["roc"].push_back({or_null(point.threshold), point.false_share, point.true_share});
  }
  json["calibration"] = Json::array();
  for (const CalibrationBin& bin : calibration(positives, negatives, calibration_parts)) {
    json["calibration"].push_back(
        {{"low", bin.low}, {"high", bin.high}, {"count", bin.count}, {"mean", bin.mean}, {"share", bin.share}});
  }
}

// False alarms per minute, recall and delay for each threshold.
Json alarms_json(const std::vector<Judged>& trials) {
  const std::vector<double> thresholds = alarm_thresholds();
  Json json = Json::array();
  for (std::size_t k = 0; k < thresholds.size(); ++k) {
    std::vector<Judgement> at;
    for (const Judged& trial : trials) {
      if (!trial.at.empty()) at.push_back(trial.at[k]);
    }
    if (at.empty()) return {};
    const Json found = summary_json(summarised(at, false)).at("figures");
    json.push_back({{"threshold", thresholds[k]}});
    for (const char* key : {"false_alarms_per_minute", "recall_of_slip", "balanced_slip_accuracy", "delay_median_s", "missed"})
      json.back()[key] = found.at(key).at("value");
  }
  return json;
}

// Number of frames by the set's class of their trial and by the network's most probable class.
Json classes_json(const std::vector<Judged>& trials, const std::vector<network::Class>& classes) {
  std::map<std::string, std::vector<std::size_t>> called;
  for (const Judged& trial : trials) {
    const bool known = std::ranges::find(classes, trial.facts.named, &network::Class::name) != classes.end();
    if (!known || trial.named.empty()) continue;
    std::vector<std::size_t>& row = called[trial.facts.named];
    row.resize(classes.size());
    for (std::size_t k = 0; k < trial.named.size(); ++k) row[k] += trial.named[k];
  }
  if (called.empty()) return {};
  Json json = {{"balanced_accuracy", 0.0}, {"called", Json::object()}};
  double sum = 0.0;
  for (std::size_t k = 0; k < classes.size(); ++k) {
    if (!called.contains(classes[k].name)) continue;
    const std::vector<std::size_t>& row = called.at(classes[k].name);
    double all = 0.0;
    for (std::size_t other = 0; other < row.size(); ++other) {
      json["called"][classes[k].name][classes[other].name] = row[other];
      all += static_cast<double>(row[other]);
    }
    sum += static_cast<double>(row[k]) / all;
  }
  json["balanced_accuracy"] = sum / static_cast<double>(called.size());
  return json;
}

// Results of the dataset's own loop, if its detector was this one.
Json loop_json(const std::vector<Judged>& trials) {
  if (std::ranges::none_of(trials, [](const Judged& trial) { return trial.as_in_loop.has_value(); })) return {};
  const bool same = std::ranges::all_of(trials, [](const Judged& trial) { return trial.as_in_loop.value_or(false); });
  std::set<std::string> detectors;
  for (const Judged& trial : trials) {
    if (!trial.loop_detector.empty()) detectors.insert(trial.loop_detector);
  }
  Json json = {{"detector", fmt::format("{}", fmt::join(detectors, ", "))}, {"same", same}};
  if (!same || !std::ranges::all_of(trials, [](const Judged& trial) { return trial.grasp.has_value(); })) return json;
  std::size_t dropped = 0, not_lifted = 0;
  std::vector<double> translation, rotation, force, reaction;
  const auto put = [](std::vector<double>& values, double value) {
    if (!std::isnan(value)) values.push_back(value);
  };
  for (const Judged& trial : trials) {
    const GraspOutcome& grasp = *trial.grasp;
    dropped += grasp.dropped ? 1U : 0U;
    not_lifted += grasp.not_lifted() ? 1U : 0U;
    put(translation, grasp.slip_translation);
    put(rotation, grasp.slip_rotation);
    put(force, grasp.max_grip_force / grasp.ideal_grip_force);
    put(reaction, grasp.reaction_time);
  }
  json["trials"] = trials.size();
  json["dropped"] = dropped;
  json["not_lifted"] = not_lifted;
  json["slip_translation_m"] = or_null(median(translation));
  json["slip_rotation_rad"] = or_null(median(rotation));
  json["force_ratio"] = or_null(median(force));
  json["reaction_time_s"] = or_null(median(reaction));
  return json;
}

// The file that training wrote and the detector reads; null: it was not trained.
const DetectorFile* trained_file(const std::string& type) {
  const DetectorKind* const kind = detector_kind(type);
  return kind != nullptr && kind->file && kind->file->is_trained() ? &*kind->file : nullptr;
}

Json trial_json(const Judged& trial) {
  const Judgement& judgement = trial.judgement;
  std::size_t frames = 0;
  for (const StateCounts& row : judgement.frames) {
    for (const std::size_t samples : row) frames += samples;
  }
  return {{"trial", judgement.trial},
          {"detection", judgement.labelled ? Json(detection_word(judgement.detection)) : Json(nullptr)},
          {"slip_time_s", or_null(judgement.slip_time)},
          {"alarm_time_s", or_null(judgement.alarm_time)},
          {"delay_s", or_null(judgement.delay)},
          {"false_alarms", judgement.stick_alarms + judgement.air_alarms},
          {"frames", frames},
          {"wrong", wrong_frames(judgement.frames)},
          {"material", trial.facts.material},
          {"object", trial.facts.object},
          {"speed_m_s", or_null(trial.facts.speed)},
          {"friction", or_null(trial.facts.friction)},
          {"mask", trial.facts.mask}};
}

// Some trials of each kind: missed; early, by how much; false alarms, by their number; seen late.
Json worst_json(const std::vector<Judged>& trials) {
  Json json = Json::array();
  const auto add = [&](Detection detection, const std::function<double(const Judgement&)>& badness, const auto& why) {
    std::vector<const Judged*> found;
    for (const Judged& trial : trials) {
      const Judgement& one = trial.judgement;
      if (one.detection == detection && !std::isnan(badness(one)))
        found.push_back(&trial);  // NaN: a trial of one sample has no delay
    }
    std::ranges::stable_sort(found, std::greater{}, [&badness](const Judged* one) { return badness(one->judgement); });
    if (found.size() > worst_of_a_kind) found.resize(worst_of_a_kind);
    for (const Judged* one : found) json.push_back({{"trial", one->judgement.trial}, {"why", why(one->judgement, one->origin)}});
  };
  const auto alarms = [](const Judgement& one) { return static_cast<double>(one.stick_alarms + one.air_alarms); };
  const auto lead = [](const Judgement& one) { return one.slip_time - one.alarm_time; };
  const auto wrong = [](const Judgement& one) { return static_cast<double>(wrong_frames(one.frames)); };
  add(Detection::missed, wrong,
      [](const Judgement& one, double origin) { return fmt::format("missed; slips from {:.4g} s", one.slip_time - origin); });
  add(Detection::early, lead,
      [&](const Judgement& one, double) { return fmt::format("alarm {:.4g} s before the slip", lead(one)); });
  add(Detection::false_alarm, alarms, [](const Judgement& one, double origin) {
    return fmt::format("false alarm at {:.4g} s; never slips", one.alarm_time - origin);
  });
  add(
      Detection::seen, [](const Judgement& one) { return one.delay; },
      [](const Judgement& one, double) { return fmt::format("detected {:.4g} s after the onset", one.delay); });
  return json;
}

// Warnings about the figures: trials on which the detector was, or may have been, trained.
Json training_warnings(const Options& options, std::size_t learnt, std::size_t judged) {
  Json warnings = Json::array();
  if (learnt > 0) {
    warnings.push_back(
        fmt::format("the detector was trained on {} of {} evaluated here, so the figures do not show its performance on new data",
                    learnt, counted(judged, "trial")));
  }
  const Json training = Json::parse(options.trained, nullptr, false);
  const DetectorFile* const file = trained_file(options.detector.type);
  if (file != nullptr && !(training.is_object() && training.contains("sha256_seen"))) {
    warnings.push_back(fmt::format("{} does not record the trials of its training, so none of them are left out{}",
                                   options.detector.parameters.path(file->parameter),
                                   training.is_object() && training.contains("trained") && training.at("trained").is_string()
                                       ? "; its description of the training: " + training.at("trained").get<std::string>()
                                       : ""));
  }
  return warnings;
}

// The evaluated trials of a dataset.
struct JudgedTrials {
  std::vector<Judged> trials;     // at least one
  Json left_out = Json::array();  // numbers of the trials that were not, since the detector was trained on them
  std::size_t learnt = 0;         // of `trials`, those on which the detector was trained
  YardstickScores yardsticks;     // of the same trials
};

JudgedTrials judged_trials(const DatasetReader& reader, const Options& options, LabelRule labels,
                           const network::Engine* network) {
  const std::map<std::size_t, std::string> part_of = reader.split();
  const std::set<std::string> seen = seen_trials(options.detector, options.trained);
  const Catalogues catalogues = program_catalogues();
  JudgedTrials judged;
  for (const std::size_t trial : reader.trials()) {
    const std::string part = part_of.contains(trial) ? part_of.at(trial) : "none", mask = part == "none" ? "" : part;
    if (!options.split.empty() && mask != options.split) continue;
    if (seen.contains(trial_identity(reader, trial))) {
      if (!options.all) {
        judged.left_out.push_back(trial);
        continue;
      }
      ++judged.learnt;
    }
    try {
      judged.trials.push_back(judged_trial(reader, trial, options, labels, catalogues,
                                           network != nullptr ? network->description().alarm : network::Alarm{},
                                           judged.yardsticks));
    } catch (const InputError& error) {
      reject("{}: trial {}: {}", reader.files()[reader.file_of(trial)], trial, error.what());
    }
    judged.trials.back().facts.mask = mask;
  }
  if (judged.trials.empty()) {
    reject("{}: no trial is left to evaluate: {}", options.dataset,
           judged.left_out.empty() ? "its split '" + options.split + "' is empty"
                                   : "the detector was trained on all of them; use other data, or --all");
  }
  return judged;
}

// The best yardstick on the same trials; null if no yardstick reads the sensor.
Json yardstick_json(const DatasetReader& reader, const Options& options, LabelRule labels, const JudgedTrials& judged_trials) {
  const std::optional<ChosenYardstick> best = judged_trials.yardsticks.best();
  if (!best) return {};
  const Catalogues catalogues = program_catalogues();
  std::vector<Judgement> judgements;
  for (std::size_t k = 0; k < judged_trials.trials.size(); ++k) {
    const Judgement& own = judged_trials.trials[k].judgement;
    const DetectorScene detector = with_yardstick_threshold(best->detector, best->thresholds.at(best->part.at(k)));
    const RecordedTrial trial = recorded_trial(reader, own.trial, detector, options.sensor, catalogues, options.resample);
    judgements.push_back(judged(own.trial, trial.truth(labels), trial.replayed));
    judgements.back().twin = own.twin;
  }
  Json areas = Json::object();
  for (const auto& [type, area] : best->areas)
    areas[type] = {{"value", area.value}, {"low", or_null(area.interval.low)}, {"high", or_null(area.interval.high)}};
  // The area does not depend on the threshold, but two thresholds scale the scores differently.
  Json all = summary_json(summarised(judgements));
  all["figures"]["auc"] = areas.at(best->detector.type);
  return {{"type", best->detector.type}, {"thresholds", best->thresholds}, {"by_halves", best->by_halves},
          {"areas", std::move(areas)},   {"left_out", best->left_out},     {"all", std::move(all)}};
}

// Result as UTF-8 text, whatever bytes the file holds.
std::string evaluated(const Options& options) {
  const DatasetReader reader = whole_dataset(options.dataset);
  for (const std::size_t trial : reader.trials()) reader.check_recorded(trial);
  const bool recordings = !reader.header().truth.empty();
  const LabelRule labels = options.labels.value_or(recordings ? LabelRule::recorded : learnt_labels(options.trained));
  if (labels != LabelRule::recorded)
    reader.check_truth("eval --labels " + label_rule_name(labels), "--labels recorded, the labels of the recordings");
  const std::unique_ptr<network::Engine> network = network_of(options.detector);
  const JudgedTrials found = judged_trials(reader, options, labels, network.get());
  const auto& [trials, left_out, learnt, scores] = found;
  std::vector<Judgement> judgements;
  Notices notices;
  for (const Judged& trial : trials) {
    judgements.push_back(trial.judgement);
    notices.add(trial.notice);
  }
  if (std::ranges::none_of(judgements, &Judgement::labelled)) reject_unlabelled(options.dataset);
  Json json = {{result_key, 1},
               {"detector", {{"type", options.detector.type}, {"parameters", parameters_json(options.detector.parameters)}}},
               {"dataset", options.dataset},
               {"sensor", trials.front().sensor},
               {"labels", label_rule_name(labels)},
               {"truth", reader.header().truth},
               {"split", options.split.empty() ? "all" : options.split},
               {"left_out", left_out},
               {"notice", notices.text()},
               {"resample", options.resample},
               {"warnings", training_warnings(options, learnt, trials.size())},
               {"all", summary_json(summarised(judgements))},
               {"by", breakdowns(trials, left_out.empty())},
               {"failed", reader.failed().size()}};
  if (network) json["reads_hz"] = reads_json(network->description().input);
  add_curves(json, trials);
  if (Json yardstick = yardstick_json(reader, options, labels, found); !yardstick.is_null())
    json["yardstick"] = std::move(yardstick);
  if (Json alarms = alarms_json(trials); !alarms.is_null()) json["alarms"] = std::move(alarms);
  if (Json classes = network ? classes_json(trials, network->description().classes) : Json(); !classes.is_null())
    json["classes"] = std::move(classes);
  if (Json loop = loop_json(trials); !loop.is_null()) json["loop"] = std::move(loop);
  json["worst"] = worst_json(trials);
  json["trials"] = Json::array();
  for (const Judged& trial : trials) json["trials"].push_back(trial_json(trial));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string training_of(const DetectorScene& detector) {
  if (const std::unique_ptr<network::Engine> engine = network_of(detector)) return engine->description().trained;
  const DetectorFile* const file = trained_file(detector.type);
  if (file == nullptr) return "{}";
  const std::string folder = hd::memories_folder(detector.parameters.path(file->parameter));
  Json training = Json::object();
  if (const auto seen = hd::seen_by(folder)) training["sha256_seen"] = *seen;
  try {
    // Published memories have no description.
    if (const hd::SavedModel saved = hd::load(folder, hd::Model{}); !saved.trained.empty()) training["trained"] = saved.trained;
  } catch (const InputError&) {
    // Creating the detector from the memories reports the error and names the file.
  }
  return training.dump(-1, ' ', false, Json::error_handler_t::replace);
}

LabelRule learnt_labels(const std::string& trained) {
  const Json training = Json::parse(trained, nullptr, false);
  if (!training.is_object() || !training.contains("labels")) return LabelRule::strict;
  const Json& labels = training.at("labels");
  try {
    if (labels.is_string()) {
      const LabelRule rule = parse_label_rule(labels.get<std::string>());
      // Simulated trials lack the labels of recordings.
      return rule == LabelRule::recorded ? LabelRule::strict : about_rule(rule).evaluated_by;
    }
  } catch (const InputError& error) {
    reject("the detector's metadata: trained.labels: {}; choose labels with --labels", error.what());
  }
  throw InputError("the detector's metadata: trained.labels is not the name of a rule; choose labels with --labels");
}

std::set<std::string> seen_trials(const DetectorScene& detector, const std::string& trained) {
  const Json training = Json::parse(trained, nullptr, false);
  if (!training.is_object() || !training.contains("sha256_seen")) return {};
  const Json& seen = training.at("sha256_seen");
  const auto is_digest = [](const Json& one) { return one.is_string() && one.get_ref<const std::string&>().size() == 64; };
  if (!seen.is_array() || !std::ranges::all_of(seen, is_digest)) {
    const DetectorFile* const file = trained_file(detector.type);
    const bool is_network = file != nullptr && file->content == DetectorFile::Content::network;
    reject("{}: metadata: trained.sha256_seen is not a list of digests of 64 hexadecimal digits each",
           is_network ? detector.parameters.path(file->parameter) : detector.type);
  }
  return {seen.begin(), seen.end()};
}

std::string detector_name(const Json& detector) {
  const Json parameters = detector.value("parameters", Json::object());
  const auto type = detector.at("type").get<std::string>();
  const DetectorFile* const file = trained_file(type);
  const std::string path = file == nullptr ? "" : parameters.value(file->parameter, "");
  if (path.empty()) return type;
  return type + (file->content == DetectorFile::Content::memories ? " with the memories " : " ") + path;
}

Json reads_json(const network::Input& input) {
  return {{"frames", network::rate_read(input)}, {"least", network::least_rate(input)}};
}

std::vector<std::string> frame_notes(const Json& result) {
  std::vector<std::string> notes;
  if (result.contains("reads_hz"))
    notes.push_back(
        "the network reads " + readable_quantity(result.at("reads_hz").at("frames").get<double>(), Quantity::frequency) +
        (result.at("reads_hz").at("least") == result.at("reads_hz").at("frames")
             ? ""
             : ", from sensors of " + readable_quantity(result.at("reads_hz").at("least").get<double>(), Quantity::frequency) +
                   " or more"));
  if (std::string notice = result.value("notice", ""); !notice.empty()) notes.push_back(std::move(notice));
  return notes;
}

std::string truth_note(const Json& result) {
  const auto truth = result.at("truth").get<std::string>();
  return truth.empty() ? truth : fmt::format("truth {}: 'true' below means the recorded label", truth);
}

std::string yardstick_note(const Json& result) {
  if (!result.contains("yardstick")) return "";
  const Json& yardstick = result.at("yardstick");
  std::vector<std::string> thresholds;
  for (const Json& threshold : yardstick.at("thresholds")) thresholds.push_back(fmt::format("{:.3g}", threshold.get<double>()));
  return fmt::format("Best yardstick: {}, a rule without training; threshold {}, chosen for the greatest balanced accuracy on {}",
                     yardstick.at("type").get<std::string>(), fmt::join(thresholds, " or "),
                     yardstick.at("by_halves").get<bool>() ? "the other half of the trials" : "these trials");
}

Json evaluate(const Options& options) { return Json::parse(evaluated(options)); }

}  // namespace slipbench::eval
