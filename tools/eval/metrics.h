// Evaluates a detector's answers by frame and by event, with confidence intervals.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string_view>

#include "tools/dataset/record/json.h"
#include "tools/eval/replay.h"
#include "tools/learning_data/label_rules.h"
#include "tools/statistics/confusion.h"
#include "tools/statistics/descriptive.h"

namespace slipbench::eval {

// Name of the labels in drawings: "labels" for recordings, else "truth".
std::string labels_title(LabelRule rule);

// The pad's state in each sample of a sensor, [T], by a rule of LabelUse::evaluation; unknown_state
// where the labels of a recording say so. `turning`: true if the motion turns the pad. Throws
// InputError as states_by().
std::vector<PadState> label_states(const SensorRecord& sensor, LabelRule rule, bool turning);

// Time of the first slip at or after `from` [s]: resolved within the step if the labels have
// events, else the first slipping sample; NaN if there is none. By the rule strict, slip begins
// when a first unit slips as a whole; by the others, and for a pad of a single unit, when a first
// part of a unit does, since a camera sees a tip move as soon as part of it detaches. `states`:
// label_states() by that rule.
double first_slip(const SensorRecord& sensor, LabelRule rule, const std::vector<PadState>& states, double from);

struct Truth {
  std::vector<double> time;  // [T] s, samples of the sensor
  // [T]; samples of unknown_state are left out of every figure, as are alarms in them.
  std::vector<PadState> state;
  std::vector<bool> masked;           // [T] samples that are not judged, although alarms in them count; empty: none
  std::vector<float> stuck_fraction;  // [T], NaN without contact
  // [T] m, path slipped since the start: sum of the mean steps of the touching units. Empty:
  // unknown.
  std::vector<double> slip_distance;
  double period = 0.0;    // s, sampling period
  bool recorded = false;  // the labels of a recording, which say nothing about the time before its first sample

  double first_slip = std::numeric_limits<double>::quiet_NaN();  // s, the slip to be detected: in a grasp the first of the lift
  // Closing fingers may make a grasp's sensor slip: from that slip to the lift no alarm counts, nor
  // any after a drop.
  double any_slip = std::numeric_limits<double>::quiet_NaN();     // s, the first slip of the trial
  double judged_from = -std::numeric_limits<double>::infinity();  // s, the lift's beginning, or the argument of truth_of()
  double judged_until = std::numeric_limits<double>::infinity();  // s, the drop
  // s, the first sample from first_slip on in which no touching unit sticks.
  double gross_slip = std::numeric_limits<double>::infinity();

  // False for a slip that begins in a sample after one of unknown state, or with the first sample of
  // a recording: it began at an unknown time before. `row`: its first sample. A recording of one
  // sample has no onset to be missed.
  [[nodiscard]] bool knows_onset(std::size_t row) const {
    return row > 0 ? state[row - 1] != unknown_state : !recorded || time.size() == 1;
  }
  // False for a sample that no figure counts.
  [[nodiscard]] bool judges(std::size_t row) const { return state[row] != unknown_state && (masked.empty() || !masked[row]); }
  // True if an alarm at that time counts (tools/dataset/outcome.md, Detection).
  [[nodiscard]] bool counts(double t) const { return (!(t >= any_slip) || t >= judged_from) && !(t >= judged_until); }
};

// Truth of one sensor of a trial. `scene`: recorded_scene(); null: the trial is imported and all of
// it counts. `from` [s]: a recording that is not a grasp is judged by the first slip from then
// on; before it, alarms count until something slips. Throws InputError as label_states(), and for a
// guided grasp without a controller, whose commands date the lift.
Truth truth_of(const Scene* scene, const TrialRecord& record, const SensorRecord& sensor, LabelRule rule,
               double from = -std::numeric_limits<double>::infinity());

// Begin [s] of the alarm seen in a sample: the time at which its estimate was available, if after
// the previous sample.
double alarm_time(const std::vector<double>& time, const Replayed& replayed, std::size_t row);

// From the first sample with slip to the first without.
struct SeenAlarm {
  double begin = 0.0, end = 0.0;  // s: alarm_time(); the first sample without slip, or the trial's last
  double probability = std::numeric_limits<double>::quiet_NaN();  // maximum during the alarm; NaN: no probability
};
// All alarms of a trial in order. `time`: [T] s, samples of the sensor.
std::vector<SeenAlarm> alarms_of(const std::vector<double>& time, const Replayed& replayed);

// A slip is found if the detector reports slip in one of its samples or less than this [s] before
// the first. If the onset of the slip is unknown, an alarm that began in or before the last sample
// without slip before it does not find it.
inline constexpr double slip_lead = 0.5;

// Result of a detector in one trial.
struct Judgement {
  std::size_t trial = 0;
  std::string twin;      // truth_sha256(): trials with equal values are one experiment; empty: unknown
  Confusion frames{};    // samples by true state and detected state
  bool labelled = true;  // false: no sample has a known state, so the trial is in no figure
  // False: the onset of the slip to be detected is unknown (Truth::knows_onset). slip_time is then
  // the first sample that is known to slip, `detection` is `seen` if the slip is found, else `missed`,
  // and there is no delay.
  bool onset_known = true;
  // From the first alarm, as in every outcome (settle_detection).
  Detection detection = Detection::quiet;
  double slip_time = std::numeric_limits<double>::quiet_NaN();   // s, true; NaN: no slip to be detected
  double alarm_time = std::numeric_limits<double>::quiet_NaN();  // s, first counting alarm; NaN: none
  // s, of Detection::seen in trials of several samples and with a known onset.
  double delay = std::numeric_limits<double>::quiet_NaN();
  bool knows_distance = false;                                            // Truth::slip_distance is known
  double whole_slip_distance = std::numeric_limits<double>::quiet_NaN();  // m, path slipped from slip_time on; NaN: unknown
  // m, path slipped from the first slip to the alarm; NaN if unknown, and for other detections than
  // `seen`.
  double slip_distance = std::numeric_limits<double>::quiet_NaN();
  bool before_gross_slip = false;  // the alarm of a seen slip came before gross slip; false if paths are unknown
  // Slips of the trial that count: runs of slipping samples. `slip_delays` [s]: of the slips with a
  // known onset that are found, 0 for a report before the slip; it stays empty for a trial of one
  // sample.
  std::size_t slips = 0, slips_found = 0;
  std::vector<double> slip_delays;
  // Number of alarms that begin while the pad truly sticks, and while it has no contact. An alarm
  // that begins in samples of unknown state begins with its first sample of known state.
  std::size_t stick_alarms = 0, air_alarms = 0;
  // s, time with stick, and without contact, in which alarms count. A trial of one sample has no
  // duration.
  double stick_time = 0.0, air_time = 0.0;
  double stuck_error = 0.0;      // sum over stuck_frames of |estimated - true| stuck fraction
  std::size_t stuck_frames = 0;  // samples in contact with an estimate
  // Probabilities of slip, one per estimate, of truly slipping samples and of others.
  std::vector<double> positives, negatives;
};

// `grace` [s]: an alarm that begins less than `grace` before the first slip is neither early nor
// false, and counts as seen without delay. Throws std::logic_error if truth and answers differ in
// length.
Judgement judged(std::size_t trial, const Truth& truth, const Replayed& replayed, double grace = 0.0);

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  Interval interval{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
};

// Area under the ROC curve of the probabilities, with its interval by experiment; NaN if a class is
// missing.
Estimate area_of(std::span<const Judgement> trials);

// Throws InputError for a dataset of this name in which no sample of any trial has a known state.
[[noreturn]] void reject_unlabelled(const std::string& dataset);

// Number of samples wrongly classified as slip or as no slip.
std::size_t wrong_frames(const Confusion& frames);

// A figure of a set of trials.
struct Figure {
  std::string_view key;   // "recall_of_slip"
  std::string_view name;  // name in tables
  enum class Unit { share, time, length, rate, number } unit;
};

// All figures with an interval, the most informative first.
inline constexpr std::array figures{
    Figure{"recall_of_slip", "recall of slip", Figure::Unit::share},
    Figure{"balanced_slip_accuracy", "balanced accuracy (slip or no slip)", Figure::Unit::share},
    Figure{"delay_median_s", "median delay after the true onset", Figure::Unit::time},
    Figure{"delay_p10_s", "10 % quantile of the delay", Figure::Unit::time},
    Figure{"delay_p90_s", "90 % quantile of the delay", Figure::Unit::time},
    Figure{"slip_distance_median_m", "median slip distance at the alarm", Figure::Unit::length},
    Figure{"before_gross_slip", "detected before gross slip (share of slipping trials)", Figure::Unit::share},
    Figure{"early", "early alarm (share of slipping trials)", Figure::Unit::share},
    Figure{"missed", "missed slip (share of slipping trials)", Figure::Unit::share},
    Figure{"slips_found", "slips found, in the slip or up to 0.5 s before (share of all slips)", Figure::Unit::share},
    Figure{"slip_delay_median_s", "median delay of the slips found", Figure::Unit::time},
    Figure{"false_alarms_per_minute", "false alarms per minute of true stick", Figure::Unit::rate},
    Figure{"false_alarm_share", "share of true stick classified as slip", Figure::Unit::share},
    Figure{"air_alarms_per_minute", "false alarms per minute without contact", Figure::Unit::rate},
    Figure{"f1_of_slip", "F1 of slip", Figure::Unit::share},
    Figure{"auc", "area under the ROC curve", Figure::Unit::share},
    Figure{"balanced_accuracy", "balanced accuracy (all classes)", Figure::Unit::share},
    Figure{"accuracy", "accuracy (all classes)", Figure::Unit::share},
    Figure{"stuck_fraction_error", "mean error of the stuck fraction", Figure::Unit::number},
};

// Summary of a set of trials.
struct Summary {
  // Trials with a known sample; `unlabelled` others are in no figure.
  std::size_t trials = 0, unlabelled = 0;
  // Trials that slip, and those of them whose onset is unknown, which are not in the shares and
  // figures of trials that follow.
  std::size_t slipping = 0, undated = 0;
  std::size_t seen = 0, early = 0, missed = 0, false_alarms = 0;
  std::size_t slips = 0, slips_found = 0;
  Confusion frames{};
  std::array<Estimate, figures.size()> estimates;  // in the order of `figures`; NaN: undefined
};

// 95 % intervals by experiment, which is a trial and its twins: exact for shares of trials (Clopper
// and Pearson) if no trial has a twin, Obuchowski's for the AUC, else by bootstrap. A percentile
// bootstrap of few experiments covers far less than 95 %, so fewer than `fewest_experiments` have
// no such interval.
inline constexpr std::size_t fewest_experiments = 10, bootstrap_draws = 1000;
inline constexpr std::uint64_t bootstrap_seed = 1;
// Without `intervals`, neither intervals nor the AUC are computed.
Summary summarised(std::span<const Judgement> trials, bool intervals = true);

// {"trials", "unlabelled", "slipping", "undated", "seen", "early", "missed", "false_alarms", "slips",
// "slips_found", "frames", "figures": {key: {"value", "low", "high"}}, "constant":
// {"balanced_slip_accuracy", "balanced_accuracy", "accuracy"} of the best constant answer, "called":
// {true state: {class: samples}}}. Undefined values are null.
Json summary_json(const Summary& summary);

}  // namespace slipbench::eval
