#include "tools/eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "sim/api/contact_frame.h"
#include "sim/api/motion.h"
#include "sim/api/pad_state_names.h"
#include "sim/core/counted.h"
#include "sim/motion/motion_catalogue.h"
#include "tools/dataset/record/slip_path.h"
#include "tools/files/reject.h"

namespace slipbench::eval {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Number of trials whose slip has a known onset.
std::size_t dated(const Summary& counts) { return counts.slipping - counts.undated; }

// Sums over trials.
struct Pool {
  Summary counts;
  std::vector<double> delays, distances;
  std::size_t before_gross_slip = 0, with_path = 0;  // trials with slip
  std::vector<double> slip_delays;
  double stick_alarms = 0.0, stick_time = 0.0, air_alarms = 0.0, air_time = 0.0, stuck_error = 0.0, stuck_frames = 0.0;

  void add(const Judgement& trial) {
    if (!trial.labelled) {
      ++counts.unlabelled;
      return;
    }
    ++counts.trials;
    slipbench::add(counts.frames, trial.frames);
    if (!std::isnan(trial.slip_time)) ++counts.slipping;
    if (!trial.onset_known) {
      ++counts.undated;
    } else {
      switch (trial.detection) {
        case Detection::quiet: break;
        case Detection::false_alarm: ++counts.false_alarms; break;
        case Detection::early: ++counts.early; break;
        case Detection::seen: ++counts.seen; break;
        case Detection::missed: ++counts.missed; break;
      }
    }
    if (!std::isnan(trial.delay)) delays.push_back(trial.delay);
    if (!std::isnan(trial.slip_distance)) distances.push_back(trial.slip_distance);
    if (trial.knows_distance && !std::isnan(trial.slip_time)) ++with_path;
    before_gross_slip += trial.before_gross_slip ? 1U : 0U;
    counts.slips += trial.slips;
    counts.slips_found += trial.slips_found;
    slip_delays.insert(slip_delays.end(), trial.slip_delays.begin(), trial.slip_delays.end());
    stick_alarms += static_cast<double>(trial.stick_alarms);
    stick_time += trial.stick_time;
    air_alarms += static_cast<double>(trial.air_alarms);
    air_time += trial.air_time;
    stuck_error += trial.stuck_error;
    stuck_frames += static_cast<double>(trial.stuck_frames);
  }
};

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : nan; }

constexpr std::size_t place_of(std::string_view key) {
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (figures[k].key == key) return k;
  }
  throw std::logic_error("no such figure");
}

// In the order of `figures`, except the AUC, which is NaN.
std::vector<double> figures_of(const Pool& pool) {
  const Confusion& frames = pool.counts.frames;
  const auto slipping = static_cast<double>(dated(pool.counts));
  std::vector<double> values(figures.size(), nan);
  const auto set = [&values](std::string_view key, double value) { values[place_of(key)] = value; };
  set("recall_of_slip", recall_of_slip(frames));
  set("balanced_slip_accuracy", balanced_slip_accuracy(frames));
  set("delay_median_s", median(pool.delays));
  set("delay_p10_s", quantile(pool.delays, 0.1));
  set("delay_p90_s", quantile(pool.delays, 0.9));
  set("slip_distance_median_m", median(pool.distances));
  set("before_gross_slip", ratio(static_cast<double>(pool.before_gross_slip), static_cast<double>(pool.with_path)));
  set("early", ratio(static_cast<double>(pool.counts.early), slipping));
  set("missed", ratio(static_cast<double>(pool.counts.missed), slipping));
  set("slips_found", ratio(static_cast<double>(pool.counts.slips_found), static_cast<double>(pool.counts.slips)));
  set("slip_delay_median_s", median(pool.slip_delays));
  constexpr PadState stick = PadState::non_slip;
  set("false_alarm_share", share_of(samples_in(frames, stick, PadState::incipient) + samples_in(frames, stick, PadState::gross),
                                    samples_in(frames, stick)));
  set("false_alarms_per_minute", 60.0 * ratio(pool.stick_alarms, pool.stick_time));
  set("air_alarms_per_minute", 60.0 * ratio(pool.air_alarms, pool.air_time));
  set("f1_of_slip", f1_of_slip(frames));
  set("balanced_accuracy", balanced_accuracy(frames));
  set("accuracy", accuracy(frames));
  set("stuck_fraction_error", ratio(pool.stuck_error, pool.stuck_frames));
  return values;
}

// Groups the trials with labels by experiment.
std::vector<std::vector<std::size_t>> experiments_of(std::span<const Judgement> trials) {
  std::vector<std::vector<std::size_t>> experiments;
  std::map<std::string, std::size_t> known;
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (!trials[k].labelled) continue;
    const std::size_t next = experiments.size();
    const std::size_t place = trials[k].twin.empty() ? next : known.try_emplace(trials[k].twin, next).first->second;
    if (place == next) experiments.emplace_back();
    experiments[place].push_back(k);
  }
  return experiments;
}

Estimate auc_of(std::span<const Judgement> trials, const std::vector<std::vector<std::size_t>>& experiments) {
  std::vector<double> positives, negatives;
  std::vector<std::size_t> positive_trial, negative_trial;
  for (std::size_t place = 0; place < experiments.size(); ++place) {
    for (const std::size_t k : experiments[place]) {
      positives.insert(positives.end(), trials[k].positives.begin(), trials[k].positives.end());
      negatives.insert(negatives.end(), trials[k].negatives.begin(), trials[k].negatives.end());
    }
    positive_trial.resize(positives.size(), place);
    negative_trial.resize(negatives.size(), place);
  }
  if (positives.empty() || negatives.empty()) return {};
  const Auc found = auc(positives, positive_trial, negatives, negative_trial);
  return {found.value, found.interval};
}

std::vector<PadState> latched(std::vector<PadState> states) {
  PadState held = PadState::no_contact;
  for (PadState& state : states) {
    state = held = state == PadState::no_contact || !slips(held) ? state : std::max(state, held);
  }
  return states;
}

// Marks samples that stick after a slip of the same contact; slips before `from` [s] do not count.
// `first_slip` [s]: the first that does, which may begin and end between two samples.
std::vector<bool> stuck_again(const std::vector<PadState>& states, const std::vector<double>& time, double from,
                              double first_slip) {
  std::vector<bool> masked;
  bool slipped = false;
  for (std::size_t row = 0; row < states.size(); ++row) {
    const bool starts = time[row] >= from && (row == 0 || time[row - 1] < from);
    if (starts || states[row] == PadState::no_contact) slipped = false;
    const bool first = time[row] >= first_slip && (row == 0 || time[row - 1] < first_slip);
    if (first || slips(states[row])) slipped = true;
    masked.push_back(slipped && states[row] == PadState::non_slip);
  }
  return masked;
}

// Start of the lift of a grasp [s]. For a guided arm, from its controller's commands, to a sample
// of the sensor.
double lift_start(const Scene& scene, const TrialRecord& record) {
  const Parameters& motion = scene.motion.parameters;
  if (!scene.guided()) return lift_times(motion).start;
  if (!record.control) throw InputError("is a grasp with a guided arm but no controller, so the start of the lift is unknown");
  const std::vector<float>& arm = record.control->grip.arm;
  for (std::size_t row = 0; 2 * row + 1 < arm.size(); ++row) {
    if (arm[2 * row + 1] > 0.0F) return record.control->time[row] + motion.number("latency");
  }
  return std::numeric_limits<double>::infinity();
}

// Linear interpolation between the rows.
double value_at(const std::vector<double>& time, const std::vector<double>& values, double t) {
  const auto next = static_cast<std::size_t>(std::ranges::lower_bound(time, t) - time.begin());
  if (next == time.size()) return values.back();
  if (next == 0) return values.front();
  return std::lerp(values[next - 1], values[next], (t - time[next - 1]) / (time[next] - time[next - 1]));
}

// The first sample, up to `before`, in which an alarm is not on since the last sample without slip
// before `before`.
std::size_t first_new_alarm(const Truth& truth, const Replayed& replayed, std::size_t before) {
  const auto holds = [&truth](std::size_t row) { return truth.state[row] != unknown_state && !slips(truth.state[row]); };
  std::size_t row = before;
  while (row > 0 && !holds(row - 1)) --row;
  if (row > 0 && slips(replayed.seen[row - 1])) {
    while (row < replayed.seen.size() && slips(replayed.seen[row])) ++row;
  }
  return row;
}

// Counts the slips and those that the detector finds, and settles the detection of a slip whose onset
// is unknown.
void judge_slips(const Truth& truth, const Replayed& replayed, Judgement& result) {
  const std::size_t rows = truth.time.size();
  for (std::size_t begin = 0, end = 0; begin < rows; begin = end + 1) {
    const std::size_t before = end;  // the end of the slip before, whose alarm is not one of this slip
    while (begin < rows && !slips(truth.state[begin])) ++begin;
    for (end = begin; end < rows && slips(truth.state[end]);) ++end;
    if (begin == rows || !truth.counts(truth.time[begin])) continue;
    ++result.slips;
    const bool known = truth.knows_onset(begin);
    std::size_t row = begin;
    while (row > before && truth.time[begin] - truth.time[row - 1] < slip_lead) --row;
    if (!known) row = std::max(row, first_new_alarm(truth, replayed, begin));
    while (row < end && !slips(replayed.seen[row])) ++row;
    const bool found = row < end;
    if (!known && truth.time[begin] == truth.first_slip) {
      result.onset_known = false;
      result.detection = found ? Detection::seen : Detection::missed;
    }
    if (!found) continue;
    ++result.slips_found;
    if (known && rows > 1) result.slip_delays.push_back(std::max(0.0, alarm_time(truth.time, replayed, row) - truth.time[begin]));
  }
}

bool turns(const Scene* scene) {
  if (scene == nullptr) return false;
  const auto& values = scene->motion.parameters.values();
  const auto rotation = values.find("rotation");
  return rotation != values.end() && std::get<double>(rotation->second) != 0.0;
}

// True if an alarm at the time `alarm` is not before the slip, or by less than `grace` [s]. Without
// slip, first_slip is NaN and no alarm is in time.
bool in_time(const Truth& truth, double alarm, double grace) {
  return alarm >= truth.first_slip || alarm > truth.first_slip - grace;
}

// Compares the alarm of the trial, if any, with the first slip.
void judge_alarm(const Truth& truth, double grace, Judgement& result) {
  const auto slipped = [&truth](double t) { return value_at(truth.time, truth.slip_distance, t); };
  if (result.knows_distance && !std::isnan(truth.first_slip))
    result.whole_slip_distance = truth.slip_distance.back() - slipped(truth.first_slip);
  TrialOutcome outcome;
  if (!std::isnan(result.alarm_time)) {
    // Without slip it is a false alarm.
    (in_time(truth, result.alarm_time, grace) ? outcome.detection_time : outcome.false_alarm_time) = result.alarm_time;
  }
  if (!result.onset_known) return;  // judge_slips() has settled it
  settle_detection(outcome, !std::isnan(truth.first_slip));
  result.detection = *outcome.detection;
  if (result.detection == Detection::seen && truth.time.size() > 1) {
    // If both times are equal they may differ in the last digit.
    const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * std::abs(truth.first_slip);
    const double delay = result.alarm_time - truth.first_slip;
    result.delay = delay <= rounding ? 0.0 : delay;
    if (result.knows_distance) {
      result.slip_distance =
          std::max(0.0, slipped(result.alarm_time) - slipped(truth.first_slip));  // 0 for an alarm within the grace period
      result.before_gross_slip = result.alarm_time < truth.gross_slip;
    }
  }
}

}  // namespace

double alarm_time(const std::vector<double>& time, const Replayed& replayed, std::size_t row) {
  const bool new_here = row == 0 || replayed.seen_since[row] > time[row - 1];
  return new_here ? replayed.seen_since[row] : time[row];
}

std::vector<SeenAlarm> alarms_of(const std::vector<double>& time, const Replayed& replayed) {
  std::vector<SeenAlarm> alarms;
  bool seen_before = false;
  for (std::size_t row = 0; row < time.size(); ++row) {
    const bool seen = slips(replayed.seen[row]);
    if (seen && !seen_before) alarms.push_back({alarm_time(time, replayed, row), time.back()});
    if (seen) alarms.back().probability = std::fmax(alarms.back().probability, replayed.probability[row]);
    if (!seen && seen_before) alarms.back().end = time[row];
    seen_before = seen;
  }
  return alarms;
}

Judgement judged(std::size_t trial, const Truth& truth, const Replayed& replayed, double grace) {
  const std::size_t rows = truth.time.size();
  if (truth.state.size() != rows || replayed.seen.size() != rows) throw std::logic_error("truth and answers differ in length");
  Judgement result;
  result.trial = trial;
  result.labelled = std::ranges::any_of(truth.state, [](PadState state) { return state != unknown_state; });
  result.slip_time = truth.first_slip;
  result.knows_distance = !truth.slip_distance.empty();
  judge_slips(truth, replayed, result);
  bool seen_before = false;
  for (std::size_t row = 0; row < rows; ++row) {
    const double time = truth.time[row];
    const PadState state = truth.state[row], seen = replayed.seen[row];
    const bool known = state != unknown_state, judges = truth.judges(row);
    if (judges) count(result.frames, state, seen);
    if (const double value = replayed.probability[row]; judges && !std::isnan(value)) {
      (slips(state) ? result.positives : result.negatives).push_back(value);
    }
    if (!truth.stuck_fraction.empty()) {
      const double error = std::abs(replayed.stuck_fraction[row] - static_cast<double>(truth.stuck_fraction[row]));
      if (!std::isnan(error)) {
        result.stuck_error += error;
        ++result.stuck_frames;
      }
    }
    const bool begins = known && slips(seen) && !seen_before;
    if (known || !slips(seen)) seen_before = slips(seen);
    const bool graced = time < truth.first_slip && in_time(truth, time, grace);
    if (!known || !truth.counts(time)) continue;
    if (slips(seen) && std::isnan(result.alarm_time)) {
      // An alarm that began before alarms count is dated at the first sample that counts.
      result.alarm_time = alarm_time(truth.time, replayed, row);
    }
    if (!judges || rows == 1) continue;  // a single sample has no duration; `period` is then that of the nominal rate
    if (state == PadState::non_slip) {
      result.stick_time += truth.period;
      result.stick_alarms += begins && !graced ? 1U : 0U;
    } else if (state == PadState::no_contact) {
      result.air_time += truth.period;
      result.air_alarms += begins && !graced ? 1U : 0U;
    }
  }
  judge_alarm(truth, grace, result);
  return result;
}

Estimate area_of(std::span<const Judgement> trials) { return auc_of(trials, experiments_of(trials)); }

void reject_unlabelled(const std::string& dataset) {
  reject(
      "{}: all labels are unknown, so there is nothing to evaluate; use `slipbench detect`, which needs none, or import recordings "
      "in which slip or hold is known",
      dataset);
}

std::size_t wrong_frames(const Confusion& frames) {
  std::size_t wrong = 0;
  for (std::size_t truth = 0; truth < frames.size(); ++truth) {
    for (std::size_t seen = 0; seen < frames.size(); ++seen) wrong += (truth >= 2) != (seen >= 2) ? frames[truth][seen] : 0;
  }
  return wrong;
}

Summary summarised(std::span<const Judgement> trials, bool with_intervals) {
  const std::vector<std::vector<std::size_t>> experiments = experiments_of(trials);
  const auto pool_of = [&](std::span<const std::size_t> drawn) {
    Pool pool;
    for (const std::size_t place : drawn) {
      for (const std::size_t k : experiments[place]) pool.add(trials[k]);
    }
    return pool;
  };
  Pool all;
  for (const Judgement& trial : trials) all.add(trial);
  Summary summary = all.counts;
  const std::vector<double> values = figures_of(all);
  std::vector<Interval> intervals(figures.size(), {nan, nan});
  if (with_intervals && experiments.size() >= fewest_experiments) {
    intervals = bootstrap_intervals(experiments.size(), bootstrap_draws, bootstrap_seed,
                                    [&](std::span<const std::size_t> drawn) { return figures_of(pool_of(drawn)); });
  }
  for (std::size_t k = 0; k < figures.size(); ++k) {
    summary.estimates[k].value = values[k];
    if (!std::isnan(values[k])) summary.estimates[k].interval = intervals[k];
  }
  if (!with_intervals) return summary;
  if (dated(summary) > 0 && experiments.size() == summary.trials) {
    summary.estimates[place_of("early")].interval = clopper_pearson(summary.early, dated(summary));
    if (!std::isnan(values[place_of("before_gross_slip")]))
      summary.estimates[place_of("before_gross_slip")].interval = clopper_pearson(all.before_gross_slip, all.with_path);
    summary.estimates[place_of("missed")].interval = clopper_pearson(summary.missed, dated(summary));
  }
  summary.estimates[place_of("auc")] = auc_of(trials, experiments);
  return summary;
}

Json summary_json(const Summary& summary) {
  Json values, called;
  for (std::size_t k = 0; k < figures.size(); ++k) {
    const Estimate& estimate = summary.estimates[k];
    values[std::string(figures[k].key)] = {
        {"value", or_null(estimate.value)}, {"low", or_null(estimate.interval.low)}, {"high", or_null(estimate.interval.high)}};
  }
  std::size_t frames = 0;
  for (const PadStateName& truth : pad_states) {
    for (const PadStateName& seen : pad_states) {
      const std::size_t count = samples_in(summary.frames, truth.value, seen.value);
      called[truth.name][seen.name] = count;
      frames += count;
    }
  }
  const double slip_or_not = summary.estimates[place_of("balanced_slip_accuracy")].value;
  return {{"trials", summary.trials},
          {"unlabelled", summary.unlabelled},
          {"slipping", summary.slipping},
          {"undated", summary.undated},
          {"seen", summary.seen},
          {"early", summary.early},
          {"missed", summary.missed},
          {"false_alarms", summary.false_alarms},
          {"slips", summary.slips},
          {"slips_found", summary.slips_found},
          {"frames", frames},
          {"figures", std::move(values)},
          {"constant",
           {{"balanced_slip_accuracy", std::isnan(slip_or_not) ? Json(nullptr) : Json(0.5)},
            {"balanced_accuracy", or_null(constant_balanced_accuracy(summary.frames))},
            {"accuracy", or_null(constant_accuracy(summary.frames))}}},
          {"called", std::move(called)}};
}

std::string labels_title(LabelRule rule) { return rule == LabelRule::recorded ? "labels" : "truth"; }

std::vector<PadState> label_states(const SensorRecord& sensor, LabelRule rule, bool turning) {
  std::vector<PadState> states = states_by(sensor, rule, turning, LabelUse::evaluation);
  return about_rule(rule).after_slip == AfterSlip::slip ? latched(std::move(states)) : states;
}

double first_slip(const SensorRecord& sensor, LabelRule rule, const std::vector<PadState>& states, double from) {
  const LabelRecord& labels = sensor.labels;
  if (labels.event_time.empty()) {
    for (std::size_t row = 0; row < states.size(); ++row) {
      if (slips(states[row]) && sensor.time[row] >= from) return sensor.time[row];
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  const bool parts = !about_rule(rule).whole_unit || labels.units() == 1;
  double first = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < labels.event_time.size(); ++k) {
    const auto kind = static_cast<EventKind>(labels.event_kind[k]);
    const bool begins = kind == EventKind::slip || (parts && kind == EventKind::micro);
    if (begins && labels.event_time[k] >= from) first = std::fmin(first, labels.event_time[k]);
  }
  return first;
}

Truth truth_of(const Scene* scene, const TrialRecord& record, const SensorRecord& sensor, LabelRule rule, double from) {
  Truth truth;
  truth.time = sensor.time;
  truth.state = label_states(sensor, rule, turns(scene));
  truth.stuck_fraction = sensor.labels.stuck_fraction;
  truth.period = 1.0 / sensor.rate;
  truth.recorded = !sensor.labels.truth;
  truth.any_slip = first_slip(sensor, rule, truth.state, truth.judged_from);
  // The lift of an imported grasp is unknown: all of its samples count.
  if (record.outcome.grasp && scene != nullptr) {
    truth.judged_from = lift_start(*scene, record);
    if (record.outcome.grasp->dropped) truth.judged_until = record.outcome.grasp->drop_time;
  } else {
    truth.judged_from = from;
  }
  truth.first_slip = first_slip(sensor, rule, truth.state, truth.judged_from);
  if (about_rule(rule).after_slip == AfterSlip::masked)
    truth.masked = stuck_again(truth.state, truth.time, truth.judged_from, truth.first_slip);
  truth.slip_distance = slip_path(sensor.labels, truth.time.size());
  for (std::size_t row = 0; row < truth.stuck_fraction.size(); ++row) {
    if (truth.stuck_fraction[row] == 0.0F && truth.time[row] >= truth.first_slip) {
      truth.gross_slip = truth.time[row];
      break;
    }
  }
  return truth;
}

}  // namespace slipbench::eval
