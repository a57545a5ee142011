#include "tools/cli/format/sweep_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/api/detector.h"
#include "sim/api/pad_state_names.h"
#include "sim/api/sensor.h"
#include "sim/core/counted.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/statistics/confusion.h"

namespace slipbench {
namespace {

constexpr std::size_t units_in_full = 40;             // a sensor with more shows only touching units
constexpr double degrees = 180.0 / std::numbers::pi;  // per radian

// "P0" if the sensor names its units like this ("P0_FX"), else the unit's number.
std::string unit_name(const Sensor& sensor, std::size_t unit) {
  const Channel& first = sensor.channels().front();
  const std::size_t units = sensor.layout().units.size();
  if (first.shape.front() == units) {
    const std::string& name = first.channel_names.at(unit * (first.size() / units));
    const bool own = name.starts_with(first.name + '_');  // "force_3_0" of a custom sensor
    if (const std::size_t end = name.find('_'); end != std::string::npos && !own) return name.substr(0, end);
  }
  return std::to_string(unit);
}

// Rank "1", ... in the order of the units' slip; "-" without slip.
std::string rank_text(const std::vector<UnitOutcome>& units, double onset) {
  constexpr double tie = 1e-9;  // s, equal except for rounding
  if (std::isnan(onset)) return "-";
  return std::to_string(
      1 + std::count_if(units.begin(), units.end(), [&](const UnitOutcome& unit) { return unit.onset_time < onset - tie; }));
}

// A slipping unit's margin is zero except for rounding: without a minus sign.
std::string margin_text(float margin) {
  if (std::isnan(margin)) return "-";
  return fmt::format("{:.3f}", std::abs(margin) < 5e-4F ? 0.0F : margin);
}

std::string class_text(const StateCounts& strict, const StateCounts& micro) {
  return fmt::format("  share of time  strict: {}\n                 micro: {}\n", shares_text(strict), shares_text(micro));
}

std::string sensor_text(const SensorSummary& sensor, const SensorAbout& about, const Style& style) {
  const std::size_t units = sensor.units.size();
  Table table({"unit", "touch", "first micro-slip", "full slip", "order", "slipped", "load at end", "margin at end"});
  std::size_t left_out = 0;
  for (std::size_t u = 0; u < units; ++u) {
    const UnitOutcome& unit = sensor.units[u];
    if (units > units_in_full && std::isnan(unit.touch_time)) {
      ++left_out;
      continue;
    }
    table.add({about.unit_names[u], onset_text(unit.touch_time), onset_text(unit.micro_onset_time), onset_text(unit.onset_time),
               rank_text(sensor.units, unit.onset_time), fmt::format("{:.2f} mm", 1e3 * unit.slip_distance),
               fmt::format("{:.2f} N", unit.load), margin_text(unit.margin)});
  }
  const std::string title =
      fmt::format("{}  {}, {} at {:g} Hz\n", style.heading(sensor.name), about.type, counted(units, "unit"), about.rate);
  const std::string others =
      left_out == 0 ? "" : fmt::format("  never in contact and not listed: {} of {}\n", left_out, counted(units, "unit"));
  return title + (left_out == units ? "" : table.text(style)) + others + class_text(sensor.state_count, sensor.state_micro_count);
}

// The motion's numbers that are neither zero nor infinite: ", speed 4 mm/s, direction 30 deg".
std::string motion_values(const Scene& scene, const Catalogues& catalogues) {
  const auto entry = std::ranges::find(catalogues.motions, scene.motion.name, &Entry::name);
  if (entry == catalogues.motions.end()) throw std::logic_error("motion is not in the catalogue: " + scene.motion.name);
  std::string text;
  for (const ParameterSpec& spec : entry->parameters) {
    if (spec.type != ParameterType::number) continue;
    const double value = scene.motion.parameters.number(spec.name);
    if (value != 0.0 && std::isfinite(value)) text += fmt::format(", {} {}", spec.name, readable_quantity(value, spec.quantity));
  }
  return text;
}

// Time from the first micro-slip to gross slip.
std::string gross_text(const TrialOutcome& outcome, const Style& style) {
  if (std::isnan(outcome.first_micro_slip_time)) return "  nothing slips\n";
  if (std::isnan(outcome.gross_slip_time)) {
    return fmt::format("  {} at {}, no gross slip\n", style.bold("first slip"), onset_text(outcome.first_micro_slip_time));
  }
  return fmt::format("  {} at {}, {:.1f} ms after the first micro-slip\n", style.bold("gross slip"),
                     onset_text(outcome.gross_slip_time), 1e3 * (outcome.gross_slip_time - outcome.first_micro_slip_time));
}

// A row of the sweep's table: number of trials that reached this stage, and the times.
std::vector<std::string> stage_row(const std::string& name, const std::vector<TrialSummary>& trials, double TrialOutcome::*time) {
  std::vector<double> times;
  for (const TrialSummary& trial : trials) {
    if (!std::isnan(trial.outcome.*time)) times.push_back(trial.outcome.*time);
  }
  if (times.empty()) return {name, "0", "-", "-", "-"};
  const auto [first, last] = std::ranges::minmax(times);
  return {name, std::to_string(times.size()), onset_text(first), onset_text(median(times)), onset_text(last)};
}

std::string percent_text(double share) { return std::isnan(share) ? "-" : fmt::format("{:.1f} %", 100.0 * share); }

std::string milliseconds_text(double time) { return std::isnan(time) ? "-" : fmt::format("{:.1f} ms", 1e3 * time); }

std::string count_of_text(std::size_t count, std::size_t total) {
  return total == 0 ? "-" : fmt::format("{} of {}", count, total);
}

// Title of a detector's figures: "force_ratio", "oracle (truth)".
std::string detector_title(const std::string& type) { return type == oracle_type ? fmt::format("oracle ({})", type) : type; }

// Outcome of one trial's grasp.
std::string grasp_text(const GraspOutcome& grasp, const Style& style) {
  std::string text = grasp.dropped        ? fmt::format("  {} at {}", style.bold("dropped"), onset_text(grasp.drop_time))
                     : grasp.not_lifted() ? fmt::format("  {}: the box stays on the table", style.bold("not lifted"))
                                          : fmt::format("  {}, slipped by {:.2f} mm and {:.2f} deg", style.bold("held"),
                                                        1e3 * grasp.slip_translation, degrees * grasp.slip_rotation);
  if (grasp.lifted.value_or(false)) text += fmt::format("; lifted by {:.1f} mm", 1e3 * grasp.lift_height);
  text += fmt::format("; grip force up to {:.2f} N", grasp.max_grip_force);
  if (!std::isnan(grasp.ideal_grip_force)) {
    text +=
        fmt::format(", {:.2f} times the ideal {:.2f} N", grasp.max_grip_force / grasp.ideal_grip_force, grasp.ideal_grip_force);
  }
  if (!std::isnan(grasp.reaction_time))
    text += fmt::format("; tightened {:.0f} ms after the first slip in the lift", 1e3 * grasp.reaction_time);
  return text + '\n';
}

std::string hold_text(const HoldOutcome& hold, const Style& style) {
  return fmt::format("  {}: moved by {:.2f} mm since {}\n", style.bold(hold.held ? "held" : "lost"), 1e3 * hold.moved,
                     onset_text(hold.from));
}

// Outcomes of the trials whose scene has `hold`; empty if there are none.
std::string holds_text(const std::vector<TrialSummary>& trials, const Style& style) {
  std::size_t held = 0, all = 0;
  for (const TrialSummary& trial : trials) {
    if (!trial.outcome.hold) continue;
    ++all;
    held += trial.outcome.hold->held ? 1 : 0;
  }
  if (all == 0) return "";
  const Interval share = clopper_pearson(held, all);
  return fmt::format("{}: {} of {}, 95 %: {:.1f} to {:.1f} %\n", style.heading("held"), held, all, 100.0 * share.low,
                     100.0 * share.high);
}

// A detector or controller with its swept parameters: "force_ratio (ratio 0.3)". `key`: their path
// in the scene.
std::string with_parameters(const std::string& type, const std::string& key, const Json& params) {
  std::string values;
  for (const auto& [path, value] : params.items()) {
    if (!path.starts_with(key + '.') || path == key + ".type" || value.is_null()) continue;
    const std::string text = value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
                             : value.is_string()     ? value.get<std::string>()
                                                     : value.dump();
    values += fmt::format("{}{} {}", values.empty() ? "" : ", ", path.substr(key.size() + 1), text);
  }
  return values.empty() ? detector_title(type) : fmt::format("{} ({})", detector_title(type), values);
}

// Name of the grasp's row; trials with equal names share a row.
std::string grasp_name(const TrialSummary& trial, bool parameters) {
  const auto params = parameters ? Json::parse(trial.params) : Json::object();
  return fmt::format("{}, {}", trial.detector ? with_parameters(trial.detector->type, "detector", params) : "no detector",
                     trial.controller.empty() ? "no controller" : with_parameters(trial.controller, "controller", params));
}

// The grasps by row name, in order of each name's first trial.
using NamedGrasps = std::vector<std::pair<std::string, std::vector<const TrialSummary*>>>;

NamedGrasps named_grasps(const std::vector<TrialSummary>& trials, bool parameters) {
  NamedGrasps groups;
  for (const TrialSummary& trial : trials) {
    if (!trial.outcome.grasp) continue;
    const std::string name = grasp_name(trial, parameters);
    const auto found = std::ranges::find(groups, name, &NamedGrasps::value_type::first);
    (found == groups.end() ? groups.emplace_back(name, std::vector<const TrialSummary*>{}) : *found).second.push_back(&trial);
  }
  return groups;
}

// Median of the values that are not NaN; NaN if there are none.
template <class Value>
double median_of(const std::vector<const TrialSummary*>& trials, const Value& value) {
  std::vector<double> values;
  for (const TrialSummary* trial : trials) {
    const double found = value(*trial->outcome.grasp);
    if (!std::isnan(found)) values.push_back(found);
  }
  return median(std::move(values));
}

std::string number_text(const char* format, double value) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

std::string grasps_text(const std::vector<GraspRow>& rows, const Style& style) {
  if (rows.empty()) return "";
  Table table({"", "held", "95 %", "dropped", "not lifted", "slip", "rotation", "max/ideal force", "reaction"});
  for (const GraspRow& row : rows) {
    table.add({row.name, fmt::format("{} of {}", row.held, row.trials),
               fmt::format("{:.1f} to {:.1f} %", 100.0 * row.held_share.low, 100.0 * row.held_share.high),
               std::to_string(row.dropped), std::to_string(row.not_lifted), number_text("{:.2f} mm", 1e3 * row.slip_translation),
               number_text("{:.2f} deg", degrees * row.slip_rotation), number_text("{:.2f}", row.force_ratio),
               number_text("{:.0f} ms", 1e3 * row.reaction_time)});
  }
  return fmt::format("{}: medians; slip and rotation of held boxes\n", style.heading("grasps")) + table.text(style);
}

// Lists the trial's sensors that had values beyond their range.
std::string saturation_text(const TrialSummary& trial, const Style& style) {
  std::string text;
  for (const SensorSummary& sensor : trial.sensors) {
    const auto found = trial.outcome.saturated.find(sensor.name);
    if (found == trial.outcome.saturated.end()) continue;
    const std::size_t samples = std::accumulate(sensor.state_count.begin(), sensor.state_count.end(), std::size_t{0});
    text += fmt::format("  {}: {}: values beyond its range in {} of {}\n", style.bold("saturated"), sensor.name, found->second,
                        counted(samples, "sample"));
  }
  return text;
}

// As above, for a sweep.
std::string saturations_text(const std::vector<TrialSummary>& trials, const Style& style) {
  std::map<std::string, std::pair<std::size_t, std::uint64_t>> by_sensor;
  for (const TrialSummary& trial : trials) {
    for (const auto& [sensor, samples] : trial.outcome.saturated) {
      ++by_sensor[sensor].first;
      by_sensor[sensor].second += samples;
    }
  }
  std::string text;
  for (const auto& [sensor, found] : by_sensor) {
    text += fmt::format("  {}: {}: values beyond its range in {} of {}, {}\n", style.bold("saturated"), sensor, found.first,
                        counted(trials.size(), "trial"), counted(found.second, "sample"));
  }
  return text;
}

// Result of one trial's detector.
std::string detection_text(const TrialOutcome& outcome) {
  switch (outcome.detection.value()) {
    case Detection::quiet: return "no slip and no alarm";
    case Detection::false_alarm: return fmt::format("false alarm at {}; nothing slips", onset_text(outcome.false_alarm_time));
    case Detection::early: return fmt::format("early alarm at {}, before the slip", onset_text(outcome.false_alarm_time));
    case Detection::seen:
      return fmt::format("slip detected {} after the onset, at {}", milliseconds_text(outcome.detection_delay),
                         onset_text(outcome.detection_time));
    case Detection::missed: return "slip missed";
  }
  throw std::logic_error("no such detection");
}

std::string detector_text(const TrialSummary& trial, const Style& style) {
  const Confusion& confusion = trial.detector->confusion;
  const std::string head = fmt::format("  {} on {}: {}", style.bold(detector_title(trial.detector->type)), trial.detector->sensor,
                                       detection_text(trial.outcome));
  if (samples_in_contact(confusion) == 0) return head + "; no contact\n";
  return fmt::format("{}; recall of slip {}, balanced accuracy {} (constant detector: {})\n", head,
                     percent_text(recall_of_slip(confusion)), percent_text(balanced_accuracy(confusion)),
                     percent_text(constant_balanced_accuracy(confusion)));
}

}  // namespace

std::string shares_text(const StateCounts& counts) {
  const auto total = static_cast<double>(std::max<std::size_t>(1, std::accumulate(counts.begin(), counts.end(), std::size_t{0})));
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    text += fmt::format("{}{} {:.1f} %", i == 0 ? "" : ", ", pad_states[i].title, 100.0 * static_cast<double>(counts[i]) / total);
  }
  return text;
}

std::string onset_text(double time) { return std::isnan(time) ? "-" : fmt::format("{:.4f} s", time); }

std::string files_text(const std::vector<std::string>& files) {
  constexpr std::size_t most = 3;
  if (files.size() <= most) return fmt::format("{}", fmt::join(files, ", "));
  return fmt::format("{} and {} more files up to {}", files.front(), files.size() - 1, files.back());
}

std::string scene_text(const Scene& scene, const Catalogues& catalogues, const Style& style, std::size_t width) {
  std::string effects;
  for (const Named& effect : scene.effects) effects += (effects.empty() ? "" : ", ") + effect.name;
  std::string text = scene.description.empty() ? "" : style.bold(scene.description) + '\n';
  const std::string shape = scene.dynamic() ? "" : fmt::format(" ({})", scene.surface.name);
  text += wrap_text(fmt::format("surface: {}{}, mu_static {:.4g}, mu_kinetic {:.4g}", scene.material, shape,
                                scene.friction.static_coefficient, scene.friction.kinetic_coefficient),
                    width, 2);
  if (!scene.model.empty()) text += "  model:   " + scene.model + '\n';
  if (!scene.bodies.empty()) {
    std::string bodies;
    for (const BodyScene& body : scene.bodies) bodies += (bodies.empty() ? "" : ", ") + body.name;
    text += wrap_text("bodies:  " + bodies, width, 2);
  }
  // If every sensor is at a site of the model, there is no stage.
  const bool on_stage = !scene.dynamic() || std::ranges::any_of(scene.sensors, [](const SensorScene& sensor) {
    return sensor.site.empty() && sensor.follows.empty();
  });
  if (on_stage) text += wrap_text(fmt::format("motion:  {}{}", scene.motion.name, motion_values(scene, catalogues)), width, 2);
  text += wrap_text("effects: " + (effects.empty() ? "none" : effects), width, 2);
  return text + '\n';
}

std::vector<SensorAbout> sensors_of(const Scene& scene) {
  std::vector<SensorAbout> result;
  for (const SensorScene& description : scene.sensors) {
    const std::unique_ptr<Sensor> sensor = make_sensor(description, scene.seed, 0);
    SensorAbout about{description.type, sensor->rate(), {}};
    for (std::size_t u = 0; u < sensor->layout().units.size(); ++u) about.unit_names.push_back(unit_name(*sensor, u));
    result.push_back(std::move(about));
  }
  return result;
}

std::string trial_text(const TrialSummary& trial, const std::vector<SensorAbout>& sensors, const Style& style) {
  std::string text;
  for (std::size_t i = 0; i < trial.sensors.size(); ++i) text += sensor_text(trial.sensors[i], sensors.at(i), style);
  text += gross_text(trial.outcome, style) + saturation_text(trial, style);
  if (trial.detector) text += detector_text(trial, style);
  if (trial.outcome.hold) text += hold_text(*trial.outcome.hold, style);
  return trial.outcome.grasp ? text + grasp_text(*trial.outcome.grasp, style) : text;
}

std::string sweep_text(const SweepSummary& summary, const Style& style) {
  Table table({"", "trials", "earliest", "median", "latest"});
  table.add(stage_row("touch", summary.trials, &TrialOutcome::touch_time));
  table.add(stage_row("first micro-slip", summary.trials, &TrialOutcome::first_micro_slip_time));
  table.add(stage_row("first full slip", summary.trials, &TrialOutcome::first_slip_time));
  table.add(stage_row("gross slip", summary.trials, &TrialOutcome::gross_slip_time));
  StateCounts strict{};
  StateCounts micro{};
  for (const TrialSummary& trial : summary.trials) {
    for (const SensorSummary& sensor : trial.sensors) {
      for (std::size_t i = 0; i < strict.size(); ++i) {
        strict[i] += sensor.state_count[i];
        micro[i] += sensor.state_micro_count[i];
      }
    }
  }
  std::string text = fmt::format("{}\n", style.heading(counted(summary.trials.size(), "trial"))) + table.text(style) +
                     class_text(strict, micro) + saturations_text(summary.trials, style);
  text += holds_text(summary.trials, style) + detectors_text(detector_scores(summary.trials), style);
  return text + grasps_text(grasp_rows(summary), style);
}

std::string detectors_text(const std::vector<DetectorScore>& scores, const Style& style) {
  if (scores.empty()) return "";
  Table table({"", "recall of slip", "balanced accuracy", "constant detector", "median delay", "worst", "detected", "early",
               "missed", "false alarms"});
  for (const DetectorScore& score : scores) {
    table.add({detector_title(score.type), percent_text(recall_of_slip(score.confusion)),
               percent_text(balanced_accuracy(score.confusion)), percent_text(constant_balanced_accuracy(score.confusion)),
               milliseconds_text(median(score.delays)), milliseconds_text(quantile(score.delays, 1.0)),
               count_of_text(score.seen(), score.slipping), count_of_text(score.early, score.slipping),
               count_of_text(score.missed, score.slipping), count_of_text(score.false_alarms, score.trials - score.slipping)});
  }
  const bool oracle_misses =
      std::ranges::any_of(scores, [](const DetectorScore& score) { return score.type == oracle_type && score.missed > 0; });
  return fmt::format("{}: shares of samples in contact; delays of detected slips; early: alarm before the slip\n",
                     style.heading("detectors")) +
         table.text(style) +
         (oracle_misses
              ? "  The oracle reports the true state at the samples of its sensor: it misses a slip that begins and ends between two "
                "samples.\n"
              : "");
}

Json detectors_json(const std::vector<DetectorScore>& scores) {
  Json list = Json::array();
  for (const DetectorScore& score : scores) {
    list.push_back({{"type", score.type},
                    {"oracle", score.type == oracle_type},
                    {"recall_of_slip", recall_of_slip(score.confusion)},
                    {"balanced_accuracy", balanced_accuracy(score.confusion)},
                    {"constant_balanced_accuracy", constant_balanced_accuracy(score.confusion)},
                    {"median_delay_s", median(score.delays)},
                    {"worst_delay_s", quantile(score.delays, 1.0)},
                    {"trials", score.trials},
                    {"slipping", score.slipping},
                    {"seen", score.seen()},
                    {"early", score.early},
                    {"missed", score.missed},
                    {"false_alarms", score.false_alarms},
                    {"accuracy", accuracy(score.confusion)},
                    {"constant_accuracy", constant_accuracy(score.confusion)},
                    {"confusion", score.confusion}});
  }
  return list;
}

std::vector<GraspRow> grasp_rows(const SweepSummary& summary) {
  constexpr std::size_t most_rows = 24;
  NamedGrasps groups = named_grasps(summary.trials, true);
  if (groups.size() > most_rows) groups = named_grasps(summary.trials, false);
  std::vector<GraspRow> rows;
  for (const auto& [name, trials] : groups) {
    const auto count = [&trials = trials](const auto& ended) {
      return static_cast<std::size_t>(
          std::ranges::count_if(trials, [&](const TrialSummary* trial) { return ended(*trial->outcome.grasp); }));
    };
    const std::size_t held = count([](const GraspOutcome& grasp) { return grasp.held(); });
    rows.push_back({.name = name,
                    .trials = trials.size(),
                    .held = held,
                    .dropped = count([](const GraspOutcome& grasp) { return grasp.dropped; }),
                    .not_lifted = count([](const GraspOutcome& grasp) { return grasp.not_lifted(); }),
                    .held_share = clopper_pearson(held, trials.size()),
                    .slip_translation = median_of(trials, [](const GraspOutcome& grasp) { return grasp.slip_translation; }),
                    .slip_rotation = median_of(trials, [](const GraspOutcome& grasp) { return grasp.slip_rotation; }),
                    .force_ratio = median_of(
                        trials, [](const GraspOutcome& grasp) { return grasp.max_grip_force / grasp.ideal_grip_force; }),
                    .reaction_time = median_of(trials, [](const GraspOutcome& grasp) { return grasp.reaction_time; })});
  }
  return rows;
}

Json grasp_json(const std::vector<GraspRow>& rows) {
  Json list = Json::array();
  for (const GraspRow& row : rows) {
    list.push_back({{"name", row.name},
                    {"trials", row.trials},
                    {"held", row.held},
                    {"dropped", row.dropped},
                    {"not_lifted", row.not_lifted},
                    {"held_share_95", {row.held_share.low, row.held_share.high}},
                    {"median_slip_translation_m", row.slip_translation},
                    {"median_slip_rotation_rad", row.slip_rotation},
                    {"median_force_ratio", row.force_ratio},
                    {"median_reaction_time_s", row.reaction_time}});
  }
  return list;
}

std::string speed_text(const SweepSummary& summary, double elapsed) {
  constexpr double shortest = 1e-9;  // s, avoids infinite rates
  const double seconds = std::max(elapsed, shortest);
  std::string text = fmt::format("{:g} s simulated in {:.3g} s, {} times real time", summary.simulated, elapsed,
                                 short_count(summary.simulated / seconds));
  if (const std::size_t simulated = summary.trials.size() - summary.resumed; simulated > 1) {
    text += fmt::format(", {} trials/s", short_count(static_cast<double>(simulated) / seconds));
  }
  return text +
         fmt::format("; {} times real time per core", short_count(summary.simulated / std::max(summary.computed, shortest)));
}

std::string steps_text(const SweepSummary& summary) {
  if (!summary.scene.grasp || summary.scene.fidelity != "field" || !(summary.longest_step > 0.0)) return "";
  const auto text = [](double step) { return fmt::format("{:.4g} ms", 1e3 * step); };
  const std::string steps = summary.shortest_step < summary.longest_step
                                ? fmt::format("{} to {}", text(summary.shortest_step), text(summary.longest_step))
                                : text(summary.longest_step);
  return fmt::format(
      "time step {}{}: onsets usually agree with those of a much shorter step within one step; `slipbench cost SCENE --accuracy onset=1%` finds the step for a given accuracy\n",
      steps, summary.scene.time_step ? "" : " (auto)");
}

void print_warnings(const std::vector<Warning>& warnings) {
  const Style style = style_for(stderr);
  for (const Warning& warning : warnings) {
    say(stderr, fmt::format("slipbench: {} {}\n", style.bold("warning:"), warning.text));
  }
}

}  // namespace slipbench
