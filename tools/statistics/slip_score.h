// The score of a slip detector in recordings without a controller, and its constants. Training
// chooses operating points by it, and the benchmark ranks detectors by it.
#pragma once

namespace slipbench {

inline constexpr double half_slip_distance = 0.25e-3;  // m, path slipped at the alarm for which a slip gives half of its credit
// m: a slip of less than this in all has no credit. Without this limit an alarm at any time would
// earn nearly all of the credit of an object that creeps by micrometres.
inline constexpr double least_slip_distance = 0.05e-3;

// Returns the credit of a slip, 0 to 1. `slipped` [m]: path that the object has slipped at the alarm.
constexpr double distance_credit(double slipped) { return half_slip_distance / (half_slip_distance + slipped); }

// Returns the score of a set of recordings, -1 to 1. `credit`: mean credit of a slip, 0 if the alarm
// comes before the slip or never. `false_share`: share of the recordings without slip in which slip is
// reported. This is the index of Youden [youden1950] with the credit in place of the
// sensitivity. If each recording with slip has a twin without slip and with the same motion, a rule
// that does not feel the pad earns at most 0, because it reports slip in both or in none.
constexpr double recording_score(double credit, double false_share) { return credit - false_share; }

}  // namespace slipbench
