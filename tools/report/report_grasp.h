// The drawings of a grasp, and its parameters.
#pragma once

#include <cstddef>
#include <string>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::report {

// {"dropped", "not_lifted", "lift_m", "drop_s", "slip_m", "rotation_rad", "max_force_N",
// "final_force_N", "ideal_force_N", "reaction_s"}; null: never, or not applicable. Stored under
// "grasp" in a row of the overview.
Json grasp_summary(const GraspOutcome& outcome);

// Time [s] of the last sample before the arm first moves; NaN without a recorded arm.
double lift_time(const TrialRecord& record);

// The curves and the poses of a grasp:
// {"lift_s": time of the last sample before the arm first moves, "detector", "controller": "" if
// absent,
//  "time": packed, "stride": row r of a curve is at time[r * stride],
//  "curves": {key: {"unit", "components", "data"}},
//  "poses": {"stride": likewise, at most 60 per second, "bodies": [{"name", "size": [3] m or null,
//   "position": packed [3] m, "turn": packed [4] quaternion w x y z}]}}.
// Curves: "height" [m] of the box's middle and of the arm above their initial positions; "slip" [m]
// of the box's middle and "rotation" [rad] of the box in the arm's frame since lift_s, 0 before and
// NaN after a drop; and with a controller or a detector "grip_force" [N, true], and "position" of
// the gripper's register [counts], commanded and measured. If they have more than `curve_values`
// values in total, every stride-th row is kept. Throws InputError, with `place` naming the trial,
// if the record has no arm or no box.
Json grasp_payload(const TrialRecord& record, std::size_t curve_values, const std::string& place);

// Every parameter of the entries grip, box, scatter (if the scene has it), of the motion `lift`, of
// `contact` with fidelity mujoco_contact, and the surface's material:
// [{"path": "grip.stiffness", "value": as in a scene, "by": "scene" (or the command line), "sweep",
// "protocol" or "default", "doc", "source", "assumed": according to its source}].
// `scene`: text of a scene file with a grasp. `overrides`: {path: YAML text} of the command line.
// `swept`: object whose keys are the swept paths; their value is "". `place` names the scene in
// messages. Throws InputError if the overrides do not fit the scene.
Json grasp_parameters(const std::string& scene, const Json& overrides, const Json& swept, const std::string& place);

}  // namespace slipbench::report
