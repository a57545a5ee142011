#include "tools/trial/sweep/warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "sim/api/detector.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "sim/effects/install.h"
#include "tools/dataset/header.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/statistics/descriptive.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/unit_sampling.h"

namespace slipbench {
namespace {

// One value of every unit; nlohmann writes NaN as null.
template <class Number>
Json column(const std::vector<UnitOutcome>& units, Number UnitOutcome::*member) {
  Json list = Json::array();
  for (const UnitOutcome& unit : units) list.push_back(unit.*member);
  return list;
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

constexpr std::size_t most_read = 64;     // trials whose values are read
constexpr std::size_t most_split = 1024;  // trials whose groups are computed
constexpr std::size_t most_built = 3;     // trials that are built to find their steps
constexpr double longest_trial = 600.0;   // s, wall-clock time

constexpr double usual_speed = 1.0;  // m/s
// Usual range in SI; values within it cause no warning.
struct Usual {
  Quantity quantity;
  double least, most;
};
constexpr std::array<Usual, 2> usual{{{Quantity::mass, 1e-6, 1e3}, {Quantity::length, 1e-6, 10.0}}};
// Only these keys: sensors and effects have lengths of all sizes.
constexpr std::array<std::string_view, 5> bodily{"bodies.", "box.", "grip.", "motion.", "surface."};

class Collector {
 public:
  Collector(const TrialPlan& plan, std::size_t trials) : plan_(plan), trials_(trials) {}

  void add(std::size_t trial, const std::string& about, const std::string& text) {
    const auto known = std::ranges::find(found_, about, [](const Found& found) { return found.warning.about; });
    if (known != found_.end()) {
      known->trials += known->last == trial ? 0 : 1;
      known->last = trial;
      return;
    }
    found_.push_back({{about, fmt::format("{}: {}: {}", plan_.where(trial, about), about, text)}, 1, trial});
  }

  [[nodiscard]] std::vector<Warning> warnings() && {
    std::vector<Warning> result;
    for (Found& found : found_) {
      if (found.trials > 1)
        found.warning.text += fmt::format("; the same or similar in {} of {} examined trials", found.trials, trials_);
      result.push_back(std::move(found.warning));
    }
    return result;
  }

 private:
  struct Found {
    Warning warning;
    std::size_t trials;
    std::size_t last;
  };
  const TrialPlan& plan_;
  std::size_t trials_;  // examined trials
  std::vector<Found> found_;
};

void look_at_values(const Trace& values, std::size_t trial, Collector& found) {
  for (const auto& [path, read] : values) {
    if (read.written.empty() || read.quantity == Quantity::none) continue;
    const double value = parse_quantity(read.written, read.quantity);
    const double size = std::abs(value);
    if (!std::isfinite(value) || value == 0.0) continue;
    if (read.quantity == Quantity::speed && size > usual_speed && quantity_of(read.written) == Quantity::none) {
      found.add(trial, path,
                fmt::format("{} has no unit, so it is in m/s; if mm/s is meant, write '{} mm/s'", read.written, read.written));
    }
    const auto range = std::ranges::find(usual, read.quantity, &Usual::quantity);
    if (range == usual.end() || (size >= range->least && size <= range->most)) continue;
    const auto starts = [&path = path](std::string_view section) { return path.starts_with(section); };
    if (range->quantity == Quantity::length && std::ranges::none_of(bodily, starts)) continue;
    found.add(trial, path,
              fmt::format("{} is unusual: {} {}", readable_quantity(value, range->quantity),
                          size < range->least ? "less than" : "more than",
                          readable_quantity(size < range->least ? range->least : range->most, range->quantity)));
  }
}

// A number of the motion; empty if it has none of that name.
std::optional<double> of_motion(const Scene& scene, const std::string& name) {
  const auto& values = scene.motion.parameters.values();
  const auto found = values.find(name);
  if (found == values.end()) return std::nullopt;
  return std::get<double>(found->second);
}

// "1.333 mm"
std::string short_length(double length) { return fmt::format("{:.4g} mm", 1e3 * length); }

bool on_stage(const SensorScene& sensor) { return sensor.site.empty() && sensor.follows.empty(); }

void look_at_motion(const Scene& scene, std::size_t trial, Collector& found) {
  if (scene.grasp || std::ranges::none_of(scene.sensors, on_stage)) return;
  const std::optional<double> start = of_motion(scene, "start"), speed = of_motion(scene, "speed"),
                              turn = of_motion(scene, "rotation");
  const bool rests = speed && turn && *speed == 0.0 && *turn == 0.0;
  if (start && *start >= scene.duration && !rests) {
    found.add(trial, "motion.start",
              fmt::format("{} is not before the end of the trial, {}, so the motion never starts",
                          format_quantity(*start, Quantity::time), format_quantity(scene.duration, Quantity::time)));
  }
  const std::optional<double> compression = of_motion(scene, "compression");
  for (const SensorScene& sensor : scene.sensors) {
    if (!compression || !on_stage(sensor)) continue;
    const double height = make_sensor(sensor, scene.seed, trial)->layout().unit_height;
    if (*compression <= height) continue;
    found.add(
        trial, "motion.compression",
        fmt::format(
            "{} exceeds the height of a unit of sensor '{}', {}; the simulated springs are compressed further than the real device could be",
            readable_quantity(*compression, Quantity::length), sensor.name, readable_quantity(height, Quantity::length)));
  }
}

// Checks one wave of an effect. Assumes the pad's axes parallel or perpendicular to the surface's, as
// on a stage.
void look_at_wave(const Scene& scene, std::size_t trial, const Named& effect, const WaveParameters& wave, Collector& found) {
  constexpr double lost = 0.1;  // share of a wave below which harmonics dominate the reading
  const double wavelength = effect.parameters.number(wave.length), angle = effect.parameters.number(wave.angle);
  const std::string path = fmt::format("effects.{}.{}", effect.name, wave.length);
  const Eigen::Vector2d k = 2.0 * std::numbers::pi / wavelength * Eigen::Vector2d(math::cos(angle), math::sin(angle));
  for (const SensorScene& sensor : scene.sensors) {
    if (sensor.friction || !sensor.follows.empty()) continue;  // no effects, or the points of another sensor
    const std::unique_ptr<Sensor> made = make_sensor(sensor, scene.seed, trial);
    const PadLayout& layout = made->layout();
    for (const UnitRange& unit : layout.units) {
      const UnitSampling sampling = sampling_of(layout, unit, k);
      const std::string points =
          fmt::format("sensor '{}': the {} points of a unit have a distance of {}, with |sum exp(i k x)|/{} = {:.3f} over them",
                      sensor.name, unit.count, short_length(sampling.spacing), unit.count, sampling.gain);
      const std::string length = readable_quantity(wavelength, Quantity::length);
      if (sampling.gain < lost && sampling.harmonic > 0) {
        found.add(
            trial, path,
            fmt::format(
                "{} is cancelled by {}; the unit vibrates at {} speed/wavelength, the harmonic at which they are in phase, instead of "
                "speed/wavelength; use points with another spacing, or one point per unit",
                length, points, sampling.harmonic));
        break;
      }
      if (sampling.phase > std::numbers::pi * (1.0 + 1e-9)) {
        found.add(trial, path,
                  fmt::format("{} is not resolved by {}, so the mean over the unit's face is wrong; use points less than half a "
                              "wavelength apart, or one point per unit",
                              length, points));
        break;
      }
    }
  }
}

void look_at_waves(const Scene& scene, std::size_t trial, Collector& found) {
  for (const Named& effect : scene.effects) {
    for (const WaveParameters& wave : effect_kind(effect.name).waves) {
      if (effect.parameters.number(wave.amplitude) > 0.0) look_at_wave(scene, trial, effect, wave, found);
    }
  }
}

void look_at_material(const Trace& values, const TrialPlan& plan, std::size_t trial, Collector& found) {
  const auto written = [&](const std::string& path) {
    const auto read = values.find(path);
    return read != values.end() && !read->second.written.empty();
  };
  if (!written("friction.static") || !written("friction.kinetic")) return;
  const auto by_command = [&](const std::string& path) { return plan.where(trial, path).starts_with("--set"); };
  if (!by_command("surface.material") || by_command("friction.static") || by_command("friction.kinetic")) return;
  found.add(
      trial, "surface.material",
      fmt::format("has no effect: friction.static and friction.kinetic of the scene ({}) replace the friction of the material",
                  plan.where(trial, "friction.static")));
}

// A duration of ten minutes or more, to two digits.
std::string long_time_text(double seconds) {
  if (seconds < 7200.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return seconds < 172800.0 ? fmt::format("{:.0f} h", seconds / 3600.0) : fmt::format("{:.2g} days", seconds / 86400.0);
}

void look_at_steps(const Scene& scene, std::size_t trial, Collector& found) {
  const PlannedSteps steps = planned_steps(scene, trial);
  if (steps.seconds <= longest_trial) return;
  found.add(trial, "time_step",
            fmt::format("{} gives steps of {:.3g} s, {:.2g} steps per trial, which take {} or more{}",
                        scene.time_step ? format_quantity(*scene.time_step, Quantity::time) : "auto", steps.shortest, steps.count,
                        long_time_text(steps.seconds), scene.time_step ? "; auto chooses the longest accurate step" : ""));
}

void count(const TrialOutcome& outcome, const std::string& sensor, const StateCounts& states,
           std::map<std::string, ConverterUse>& sensors) {
  ConverterUse& use = sensors[sensor];
  const auto found = outcome.saturated.find(sensor);
  if (found != outcome.saturated.end()) use.at_an_end += found->second;
  use.samples += std::accumulate(states.begin(), states.end(), std::uint64_t{0});
}

}  // namespace

std::vector<Warning> scene_warnings(const TrialPlan& plan, std::span<const std::size_t> numbers, bool build) {
  const std::vector<std::size_t> read = evenly_spaced(numbers.size(), most_read);
  const std::vector<std::size_t> built = evenly_spaced(read.size(), build ? most_built : 0);
  Collector found(plan, read.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    const std::size_t trial = numbers[read[i]];
    try {
      Trace values;
      const Scene scene = plan.read(trial, values);
      look_at_values(values, trial, found);
      look_at_motion(scene, trial, found);
      look_at_waves(scene, trial, found);
      look_at_material(values, plan, trial, found);
      if (std::ranges::find(built, i) != built.end()) look_at_steps(scene, trial, found);
    } catch (const InputError&) {
      continue;
    }
  }
  return std::move(found).warnings();
}

std::vector<Warning> split_warnings(const TrialPlan& plan, std::span<const std::size_t> numbers) {
  std::vector<std::pair<std::size_t, std::string>> trials;
  std::optional<SplitRule> rule;
  for (const std::size_t k : evenly_spaced(numbers.size(), most_split)) {
    const std::size_t trial = numbers[k];
    try {
      const TrialPlan::Trial planned = plan.trial(trial);
      rule = split_rule(planned.scene);
      const bool one_material =
          std::ranges::none_of(planned.drawn, [](const auto& swept) { return swept.first == "surface.material"; });
      if (!rule && one_material) return {};
      // Before the trials have run, repeats are certain only without effects, which may draw numbers.
      std::vector<std::string> experiment;
      if (planned.scene.effects.empty()) experiment.push_back(experiment_of(planned.scene, planned.drawn));
      trials.emplace_back(trial, split_group_text(split_group(planned.scene), experiment));
    } catch (const InputError&) {
      continue;
    }
  }
  const Masks masks = split_trials(trials, 0, rule);
  if (!rule && masks.split_by == "trial") return {};
  const std::array<double, 3> shares = rule ? rule->shares : std::array<double, 3>{1.0, 1.0, 1.0};
  std::vector<std::string> empty;
  if (shares[1] > 0.0 && masks.valid.empty()) empty.emplace_back("valid");
  if (shares[2] > 0.0 && masks.test.empty()) empty.emplace_back("test");
  if (empty.empty() || trials.empty()) return {};
  const std::string remedy =
      masks.split_by == "trial"
          ? "repeats of one experiment stay in one part, so sweep or draw a key that changes the contact, such as motion.speed"
          : fmt::format("'split: {{by: trial}}' divides the trials, with trials of one {} in several parts", masks.split_by);
  return {{"split", fmt::format("{}: split: by {} there {} only {} to divide, so {} without trials; {}",
                                plan.where(trials.front().first, "split"), masks.split_by, masks.groups == 1 ? "is" : "are",
                                masks.groups, empty.size() == 2 ? "valid and test are" : empty.front() + " is", remedy)}};
}

std::vector<Warning> scene_warnings(const ReadSweep& read, const SweepOptions& sweep) {
  const PlannedTrials& planned = read.planned;
  std::vector<std::size_t> numbers;
  if (sweep.only) {
    numbers.push_back(*sweep.only);
  } else {
    numbers.resize(planned.requested);
    std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  }
  std::vector<Warning> warnings;
  try {
    const auto look = [&] { return warnings_json(scene_warnings(planned.plan, numbers, true)).dump(); };
    for (const Json& one : Json::parse(run_before_trials(sweep, std::min(numbers.size(), most_read), look)))
      warnings.push_back({one.at("about"), one.at("text")});
  } catch (const InputError&) {
    // Running the trial reports the reason.
  }
  if (!sweep.output.empty()) std::ranges::move(split_warnings(planned.plan, numbers), std::back_inserter(warnings));
  return warnings;
}

std::vector<Warning> converter_warnings(const std::map<std::string, ConverterUse>& sensors) {
  std::vector<Warning> warnings;
  for (const auto& [name, use] : sensors) {
    if (2 * use.at_an_end <= use.samples) continue;
    warnings.push_back(
        {"sensors." + name + ".electronics",
         fmt::format(
             "sensor '{}' has values beyond its range in {} of {}, where its converter clips them or its accuracy is not specified",
             name, use.at_an_end, counted(use.samples, "sample"))});
  }
  return warnings;
}

void count_converters(const TrialRecord& record, std::map<std::string, ConverterUse>& sensors) {
  for (const SensorRecord& sensor : record.sensors) count(record.outcome, sensor.name, sensor.labels.state_count, sensors);
}

std::vector<Warning> trial_warnings(const std::vector<TrialSummary>& trials) {
  std::map<std::string, ConverterUse> sensors;
  std::map<std::string, std::size_t> notices;  // trials of each
  for (const TrialSummary& trial : trials) {
    for (const SensorSummary& sensor : trial.sensors) count(trial.outcome, sensor.name, sensor.state_count, sensors);
    if (trial.detector && !trial.detector->notice.empty()) ++notices[trial.detector->notice];
  }
  std::vector<Warning> warnings = converter_warnings(sensors);
  for (const auto& [notice, count] : notices) {
    warnings.push_back(
        {"detector", "detector: " + notice +
                         (count == trials.size() ? "" : fmt::format(" in {} of {}", count, counted(trials.size(), "trial")))});
  }
  return warnings;
}

Json warnings_json(const std::vector<Warning>& warnings) {
  Json list = Json::array();
  for (const Warning& warning : warnings) list.push_back({{"about", warning.about}, {"text", warning.text}});
  return list;
}

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
               {"time_step_s", summary.longest_step > 0.0 ? Json{summary.shortest_step, summary.longest_step} : Json(nullptr)},
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
