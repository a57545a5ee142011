// What a detector's answers come to, whatever detector it is: by frame, by event, and how far the figures can be trusted.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/confusion.h"
#include "tools/base/statistics/roc.h"
#include "tools/program/eval/replay.h"
#include "tools/program/eval/truth.h"

namespace slipbench::eval {

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

// A figure of a set of trials.
struct Figure {
  std::string_view key;   // "recall_of_slip"
  std::string_view name;  // as tables have it
  enum class Unit { share, time, rate, number } unit;
};

// All figures of which an interval is known, the most telling first.
inline constexpr std::array figures{
    Figure{"recall_of_slip", "recall of slip", Figure::Unit::share},
    Figure{"balanced_slip_accuracy", "balanced accuracy, slip or not", Figure::Unit::share},
    Figure{"delay_median_s", "delay from the true first slip, median", Figure::Unit::time},
    Figure{"delay_p10_s", "delay, 10 %", Figure::Unit::time},
    Figure{"delay_p90_s", "delay, 90 %", Figure::Unit::time},
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
// twin, of the AUC Obuchowski's, else by bootstrap with seed 1 and 1000 draws. A percentile bootstrap of a handful covers far less than it says, so
// fewer than `fewest_experiments` have no such interval.
inline constexpr std::size_t fewest_experiments = 10;
// Without `intervals` there are none, nor an AUC.
Summary summarised(std::span<const Judgement> trials, bool intervals = true);

// {"trials", "slipping", "seen", "early", "missed", "false_alarms", "frames", "figures": {key: {"value", "low", "high"}}, "constant":
// {"balanced_slip_accuracy", "balanced_accuracy", "accuracy"} of the best constant answer, "called": {true state: {class: samples}}}. What does not
// exist is null.
Json summary_json(const Summary& summary);

}  // namespace slipbench::eval
