// The score of a slip detector in recordings without a controller, and its constants. Training
// chooses operating points by it, and the benchmark ranks detectors by it.
#pragma once

#include <algorithm>

namespace slipbench {

inline constexpr double alarm_limit = 1.0;             // false alarms per minute up to which credit counts in full
inline constexpr double half_slip_distance = 0.25e-3;  // m, path slipped at the alarm for which a slip gives half of its credit
// m: a slip of less than this in all has no credit. Without this limit an alarm at any time would
// earn nearly all of the credit of an object that creeps by micrometres.
inline constexpr double least_slip_distance = 0.05e-3;

// Returns the credit of a slip, 0 to 1. `slipped` [m]: path that the object has slipped at the alarm.
constexpr double distance_credit(double slipped) { return half_slip_distance / (half_slip_distance + slipped); }

// Returns the score of a set of recordings, -1 to 1. `credit`: mean credit of a slip.
// `alarms_per_minute`: false alarms per minute without slip. `said`: share of the samples without
// slip in which slip is reported.
constexpr double recording_score(double credit, double alarms_per_minute, double said) {
  return credit * (alarm_limit / std::max(alarms_per_minute, alarm_limit)) - said;
}

}  // namespace slipbench
