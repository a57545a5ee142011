// What became of a box that the controller `reorient` was to turn up and put down.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "tools/base/record/trial_record.h"
#include "tools/base/statistics/descriptive.h"

namespace slipbench::reproduce {

// How a trial ended. The phases are told apart by the arm: it rises while the grip is adjusted and the box turns, and goes sideways in the
// release.
enum class TurnEnd : std::size_t {
  standing,      // as TurnOutcome has it
  lost,          // before the release no pad touched it any more: the grip let go
  told_early,    // released below TargetPoint, where upright is told, and never nearer than `turned_up` to upright
  not_turned,    // the same at TargetPoint: it hung in the grip, or lay
  fell,          // released, nearer than that to upright at some time, and not upright in the end
  not_let_go,    // upright in the end, but a pad touches it or the table does not carry it
  not_released,  // the arm rose to the end of the trial
};
inline constexpr std::size_t turn_ends = 7;
inline constexpr std::array<const char*, turn_ends> turn_end_names{"standing", "lost",       "told_early",  "not_turned",
                                                                   "fell",     "not_let_go", "not_released"};

inline constexpr double turned_up = 0.349065850398865915;  // rad, 20 degrees

struct Turn {
  TurnEnd end = TurnEnd::standing;
  // At the release's beginning, NaN without one:
  double tilt;   // rad, of the box's own axis Y against the vertical
  double force;  // N, mean of both pads'
};

// `record`: a full one of a grasp whose arm is guided. `target`: the rise of TargetPoint [m]. Throws std::logic_error where the record has
// not what it takes: the outcome's turn, the bodies `arm` and `box`, and the loop's rows at the same times.
Turn turn_of(const TrialRecord& record, double target);

// A trial, and what the trials of a cell come to.
struct ReorientRun {
  bool standing = false, dropped = false;
  double tilt = 0.0, least_tilt = 0.0;  // rad, at the end and ever
  double most_force = 0.0;              // N
  Turn turn;
};
using ReorientRuns = std::vector<ReorientRun>;

struct ReorientSummary {
  std::size_t runs = 0, standing = 0, turned_up = 0, dropped = 0;
  std::array<std::size_t, turn_ends> ends{};                                                  // runs of each TurnEnd
  double tilt = 0.0, least_tilt = 0.0, most_force = 0.0, released_tilt = 0.0, held_by = 0.0;  // medians; rad, N; NaN of none
};
ReorientSummary summary_of(const ReorientRuns& runs);

// What Algorithm 1 makes of the slow releases of Table II of the nib pad's paper.

// What one run came to with one reading. NaN: nothing was detected before the slip was over.
struct ReleaseRun {
  std::string material;
  double required = 0.0;                                    // N, pull/mu_s
  double force = std::numeric_limits<double>::quiet_NaN();  // N, true, at the detection
  double way = std::numeric_limits<double>::quiet_NaN();    // m, slip at the detection

  [[nodiscard]] bool safe() const { return way < 6e-3; }  // a success in the paper
  [[nodiscard]] bool gross() const { return safe() && force < required; }
};

struct ReleaseSummary {
  std::size_t runs = 0, safe = 0, early = 0;
  MeanSd error, gross_error, slip;  // N, N, mm; of the safe ones
};
// Of the runs on a material; of all where it is empty.
ReleaseSummary summary_of(const std::vector<ReleaseRun>& runs, const std::string& material);

}  // namespace slipbench::reproduce
