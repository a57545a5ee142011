// The rank score: what a detector is worth. README.md says what raises it and what does not.
#pragma once

#include <span>

#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/binomial.h"
#include "tools/program/benchmark/protocol.h"
#include "tools/program/eval/metrics.h"

namespace slipbench::benchmark {

// What one trial gives.
struct Part {
  double credit = 0.0;    // 0 to 1
  bool credited = true;   // false: the trial has nothing to earn, as a recording without slip
  double alarms = 0.0;    // false alarms begun, the early ones among them
  double quiet = 0.0;     // s without true slip in which they are counted
  double needless = 0.0;  // 0 to 1, of a grasp that needs no tightening
  double said = 0.0;      // samples without true slip that are called slip,
  double still = 0.0;     // of so many
};

// Of a recording: the credit is half_delay / (half_delay + delay) of a slip that is seen, 0 of one that is missed or alarmed early.
Part recording_part(const eval::Judgement& judgement);
// Of a grasp that `untightened`, that of who never tightens, drops: the credit is (worst_force_ratio - r) / (worst_force_ratio - 1) of a box that is
// held, r the greatest grip force over the least that holds, at most 1 and at least 0; 0 of one that is dropped. Of a grasp that who never
// tightens holds there is nothing to earn; its `needless` is (r - 1) / (worst_force_ratio - 1), r the greatest grip force over that of who never
// tightens, at most 1 and at least 0.
Part grasp_part(const eval::Judgement& judgement, const GraspOutcome& grasp, const GraspOutcome& untightened);

struct Score {
  double credit = 0.0;             // mean over the trials that have something to earn; 0 where none has
  double alarms_per_minute = 0.0;  // of time without true slip
  double said = 0.0;               // share of the samples without true slip that are called slip
  double needless = 0.0;           // mean over the grasps that need no tightening; 0 where there is none
  // The credit times min(1, alarm_limit / alarms_per_minute), less `said`: -1 to 1. In a loop the credit less `said`, since a false alarm has cost
  // force there, and where Held::needless less `needless`: -2 to 1.
  double value = 0.0;
};
Score score_of(std::span<const Part> parts, const Held& held);

// 95 % by trial, by bootstrap as eval::summarised(); NaN of fewer than eval::fewest_experiments.
Interval score_interval(std::span<const Part> parts, const Held& held);

}  // namespace slipbench::benchmark
