// Slip onset in closed form, where there is one: a reference that no step and no code of the field has a part in.
//
// An element on a plane sticks where it touched until its spring pulls harder than friction holds,
//   k_t |p(t) - p(t_touch)| = mu_s k_n d(t),
// with the motion's own place p of its tip along the plane and depth d of its tip in it. All springs of a pad are clamped to one
// body that moves as prescribed, so no element knows of another, and the first t that solves this is its onset exactly; mu_k has
// no part in it. For one pillar in translation at constant speed v it is mu_s f_n/(k_t v) after the start.
// A unit slips in part from the first onset of its elements on, and as a whole from the last one on if till then all that slipped
// go on.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/program/cost/errors.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

struct ClosedForm {
  struct Onset {
    double time = std::numeric_limits<double>::quiet_NaN();  // s; NaN: never in the trial
    double load_time =
        least_load_time;  // s, twice the time since half of the friction was used up, or the time since the touch; no less
  };
  struct Unit {
    Onset micro, whole;
  };
  std::vector<std::vector<Unit>> units;  // [sensor][N]
};

// The onsets of one trial, resolved to rounding. Empty unless all of this holds: nothing moves by forces, the surface is a plane,
// there are no effects, mu_s > 0, pads have no dashpots, axes look at the plane throughout, and in every unit of several elements
// what slips goes on until all of it does (between the unit's first onset and its last, or the trial's end, each tip keeps its
// depth, moves, and never turns by 90 degrees or more from where it moved at first).
// Throws InputError as make_sensor() and make_motion() do.
std::optional<ClosedForm> closed_form(const Scene& scene, std::uint64_t trial);

// The measures onset and micro_onset of a run (Recording::outcome is enough) as compare() has them, against the closed form; no
// other measure applies.
Errors compare(const Scene& scene, const TrialResult& run, const ClosedForm& exact);

}  // namespace slipbench
