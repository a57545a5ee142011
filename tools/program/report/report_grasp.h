// What the page draws of a grasp beside the sensor: the gripper, the box and the loop that moves them.
#pragma once

#include <cstddef>
#include <string>

#include "tools/base/page/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::report {

// {"dropped", "drop_s", "slip_m", "rotation_rad", "max_force_N", "final_force_N", "ideal_force_N", "reaction_s"}: null: never, or
// it does not apply. A row of the overview has it under "grasp".
Json grasp_summary(const GraspOutcome& outcome);

// Time [s] of the last sample before the arm first moves; NaN without a recorded arm.
double lift_time(const TrialRecord& record);

// The curves and the poses of a grasp:
// {"lift_s": time of the last sample before the arm first moves, "detector", "controller": "" without one,
//  "time": packed, "stride": row r of a curve belongs to time[r * stride], "curves": {key: {"unit", "components", "data"}},
//  "poses": {"stride": likewise, at most 60 a second, "bodies": [{"name", "size": [3] m or null, "position": packed [3] m, "turn": packed
//  [4] quaternion w x y z}]}}.
// Curves: "height" [m] of the box's middle and of the arm over where they began; "slip" [m] of the box's middle and "rotation" [rad] of the box in the arm's
// frame since lift_s, 0 before and NaN once dropped; and with a controller or a detector "grip_force" [N, true], and "position" of the gripper's
// register [counts], commanded and measured. When they have more than `curve_values` values in all, every stride-th row is kept.
// Throws InputError, with `place` naming the trial, where the record has no arm or no box.
Json grasp_payload(const TrialRecord& record, std::size_t curve_values, const std::string& place);

}  // namespace slipbench::report
