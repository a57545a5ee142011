// What a detector's answers come to, whatever detector it is: by frame, by event, and how far the figures can be trusted.
#pragma once

#include <array>
#include <limits>
#include <string_view>

#include "tools/base/record/json.h"
#include "tools/base/statistics/confusion.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/program/eval/replay.h"

namespace slipbench::eval {

// The names of PadState in results.
inline constexpr std::array state_words{"no_contact", "non_slip", "incipient", "gross"};

// By which rule a sensor's pad slips in a sample.
enum class TruthRule {
  strict,       // labels/state: a unit slips when all of it slips
  micro,        // labels/state_micro: as soon as a part of it does
  paper,        // labels/state_paper: as the sensor's paper has it
  latched,      // micro, and what has slipped stays so until the whole pad loses contact, though it may have come to rest
  masked,       // micro, and what sticks again after a slip, before contact is lost, is neither right nor wrong
  has_slipped,  // of a PapillArray alone: a pillar whose tip was fast (SlipRule) stays so until it loses contact
  recorded,     // the labels of an imported recording, which were made by hand or by its own set
};

// "strict", ... The parser throws InputError with the nearest name.
std::vector<std::string> label_rule_names();
TruthRule parse_label_rule(const std::string& name);
std::string label_rule_name(TruthRule rule);
// How drawings name the states by the rule: "labels" of recordings, else "truth".
std::string labels_title(TruthRule rule);

// The pad's state in each sample of a sensor, [T]. `turning`: the motion turns the pad, which has_slipped asks. Throws InputError for
// has_slipped of another sensor, and for labels that are no states or not one a sample.
std::vector<PadState> label_states(const SensorRecord& sensor, TruthRule rule, bool turning);

// When slip first begins at or after `from` [s]: resolved inside the step where the labels have events, else the first sample that slips; NaN:
// never. Of the rule strict it is a first unit as a whole; of the others, and of a pad of a single unit, a first part of a unit: a camera
// sees a tip move as soon as a part of it lets go. `states`: label_states() by that rule.
double first_slip(const SensorRecord& sensor, TruthRule rule, const std::vector<PadState>& states, double from);

struct Truth {
  std::vector<double> time;           // [T] s, samples of the sensor
  std::vector<PadState> state;        // [T]
  std::vector<bool> masked;           // [T] no frame to be judged by, though alarms in it count; empty: none is
  std::vector<float> stuck_fraction;  // [T], NaN while nothing touches
  // [T] m, path slipped since the start: sum of the mean steps of the touching units. Empty: not known.
  std::vector<double> slip_distance;
  double period = 0.0;  // s, from one sample to the next

  double first_slip = std::numeric_limits<double>::quiet_NaN();  // s, the one to be judged by: in a grasp the first of the lift
  // Closing fingers may make a grasp's sensor slip; from then until the lift no alarm counts, and none from a drop on.
  double any_slip = std::numeric_limits<double>::quiet_NaN();     // s, the first at all
  double judged_from = -std::numeric_limits<double>::infinity();  // s, the lift's beginning, or what truth_of() was given
  double judged_until = std::numeric_limits<double>::infinity();  // s, the drop
  // s, the first sample from first_slip on in which nothing that touches sticks.
  double gross_slip = std::numeric_limits<double>::infinity();

  // Whether an alarm at that time counts (dataset/README.md, How the detector did).
  [[nodiscard]] bool counts(double t) const { return (!(t >= any_slip) || t >= judged_from) && !(t >= judged_until); }
};

// That of one sensor of a trial. `scene`: recorded_scene(); null: the trial is no simulation's, and all of it counts. `from` [s]: a recording that
// is no grasp is judged by the first slip from then on; before it alarms count until something slips. Throws InputError as label_states(), and for a
// guided grasp without a controller, which says when it is lifted.
Truth truth_of(const Scene* scene, const TrialRecord& record, const SensorRecord& sensor, TruthRule rule,
               double from = -std::numeric_limits<double>::infinity());

// When the alarm that is seen in a sample began [s]: as its estimate was there, where that was after the sample before.
double alarm_time(const std::vector<double>& time, const Replayed& replayed, std::size_t row);

// From the first sample that sees slip to the first that does not.
struct SeenAlarm {
  double begin = 0.0, end = 0.0;  // s: alarm_time(); the first sample without it, or the trial's last
  double probability = std::numeric_limits<double>::quiet_NaN();  // the highest meanwhile; NaN: the detector has none
};
// The alarms of a trial in order, whether they count or not. `time`: [T] s, the samples of the sensor.
std::vector<SeenAlarm> alarms_of(const std::vector<double>& time, const Replayed& replayed);

// How a detector did in one trial.
struct Judgement {
  std::size_t trial = 0;
  std::string twin;    // truth_sha256(): trials in which it is equal are one experiment; empty: not known
  Confusion frames{};  // samples of the sensor by true state and by what is seen
  // By the first alarm, as in every outcome (settle_detection).
  Detection detection = Detection::quiet;
  double slip_time = std::numeric_limits<double>::quiet_NaN();   // s, true; NaN: none to be judged by
  double alarm_time = std::numeric_limits<double>::quiet_NaN();  // s, the first that counts; NaN: none
  double delay = std::numeric_limits<double>::quiet_NaN();  // s, of Detection::seen alone, where the trial has several samples
  bool knows_distance = false;                              // Truth::slip_distance is known
  double whole_slip_distance = std::numeric_limits<double>::quiet_NaN();  // m, path slipped from slip_time on; NaN: not known
  // m, path slipped from the first slip to the alarm; NaN where it is not known, and for other detections than `seen`.
  double slip_distance = std::numeric_limits<double>::quiet_NaN();
  bool before_gross_slip = false;  // the alarm of a slip that is seen came before gross slip; false where paths are not known
  // An alarm is false where slip begins to be seen while the pad truly sticks, or touches nothing.
  std::size_t stick_alarms = 0, air_alarms = 0;
  // s, for which the pad sticks, or touches nothing, and alarms count. A trial of one sample lasts no time.
  double stick_time = 0.0, air_time = 0.0;
  double stuck_error = 0.0;      // sum over stuck_frames of |estimated - true| stuck fraction
  std::size_t stuck_frames = 0;  // samples with an estimate of it, in contact
  // Probabilities of slip, one an estimate, of samples that truly slip and of those that do not.
  std::vector<double> positives, negatives;
};

// `grace` [s]: an alarm that begins less than that before the first slip is neither early nor false, and is seen without delay. Throws
// std::logic_error where both have not the same samples.
Judgement judged(std::size_t trial, const Truth& truth, const Replayed& replayed, double grace = 0.0);

// Samples that are called slip and do not slip, or the other way round.
std::size_t wrong_frames(const Confusion& frames);

// A figure of a set of trials.
struct Figure {
  std::string_view key;   // "recall_of_slip"
  std::string_view name;  // as tables have it
  enum class Unit { share, time, length, rate, number } unit;
};

// All figures of which an interval is known, the most telling first.
inline constexpr std::array figures{
    Figure{"recall_of_slip", "recall of slip", Figure::Unit::share},
    Figure{"balanced_slip_accuracy", "balanced accuracy, slip or not", Figure::Unit::share},
    Figure{"delay_median_s", "delay from the true first slip, median", Figure::Unit::time},
    Figure{"delay_p10_s", "delay, 10 %", Figure::Unit::time},
    Figure{"delay_p90_s", "delay, 90 %", Figure::Unit::time},
    Figure{"slip_distance_median_m", "slipped distance at the alarm, median", Figure::Unit::length},
    Figure{"before_gross_slip", "seen before gross slip, of the trials that slip", Figure::Unit::share},
    Figure{"early", "early, of the trials that slip", Figure::Unit::share},
    Figure{"missed", "missed, of the trials that slip", Figure::Unit::share},
    Figure{"false_alarms_per_minute", "false alarms a minute of true stick", Figure::Unit::rate},
    Figure{"false_alarm_share", "share of true stick called slip", Figure::Unit::share},
    Figure{"air_alarms_per_minute", "false alarms a minute without contact", Figure::Unit::rate},
    Figure{"f1_of_slip", "F1 of slip", Figure::Unit::share},
    Figure{"auc", "area under the ROC curve", Figure::Unit::share},
    Figure{"balanced_accuracy", "balanced accuracy of the classes", Figure::Unit::share},
    Figure{"accuracy", "accuracy of the classes", Figure::Unit::share},
    Figure{"stuck_fraction_error", "stuck fraction, mean error", Figure::Unit::number},
};

struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  Interval interval{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
};

// The trials of a set together.
struct Summary {
  std::size_t trials = 0, slipping = 0, seen = 0, early = 0, missed = 0, false_alarms = 0;  // trials
  Confusion frames{};
  std::array<Estimate, figures.size()> estimates;  // in the order of `figures`; NaN: does not exist
};

// Intervals are of 95 % and by experiment, which is a trial and its twins: of shares of trials exact (Clopper and Pearson) where no trial has a
// twin, of the AUC Obuchowski's, else by bootstrap. A percentile bootstrap of a handful covers far less than it says, so
// fewer than `fewest_experiments` have no such interval.
inline constexpr std::size_t fewest_experiments = 10, bootstrap_draws = 1000;
inline constexpr std::uint64_t bootstrap_seed = 1;
// Without `intervals` there are none, nor an AUC.
Summary summarised(std::span<const Judgement> trials, bool intervals = true);

// {"trials", "slipping", "seen", "early", "missed", "false_alarms", "frames", "figures": {key: {"value", "low", "high"}}, "constant":
// {"balanced_slip_accuracy", "balanced_accuracy", "accuracy"} of the best constant answer, "called": {true state: {class: samples}}}. What does not
// exist is null.
Json summary_json(const Summary& summary);

}  // namespace slipbench::eval
