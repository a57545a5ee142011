// The parts of the page's data: what its overview says of a dataset, and what it draws of a trial.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/base/record/json.h"
#include "tools/base/record/trial_record.h"
#include "tools/program/report/report.h"

namespace slipbench {
class DatasetReader;
}

namespace slipbench::report {

inline constexpr float at_rest = 1e-6F;  // m/s or rad/s: below this a prescribed motion only rounds

// Each number, or null where it is not finite.
Json numbers_or_null(const std::vector<double>& values);

// First touch of each unit [s]; NaN: never.
std::vector<double> touch_times(const LabelRecord& labels);

// Throws InputError when the labels hold a state, a unit or a kind of event that does not exist, no sample at all, or a time that
// is not finite. `place` names the trial in the message.
void check_labels(const SensorRecord& sensor, const std::string& place);

// Time [s] of the first sideways (world x, y) or turning motion of any body of the trial at or after `from` [s]; NaN when there
// is none. A press along z does not count.
double motion_start(const TrialRecord& trial, double from);

// {"units", "shares": {"strict": [4], "micro": [4], "paper": [4]} (share of the samples in each state),
//  "first_touch_s", "first_micro_s", "first_full_s", "gross_s" (rule strict, resolved inside the step by the slip event that
//  completes it), "incipient_s" (duration from first_micro_s to gross_s), "max_slip_m",
//  "disagreement": {"paper", "micro"} (share of the samples in contact where that rule differs from strict)}.
// null stands for never.
Json summarise(const SensorRecord& sensor);

// {"name", "type", "rate_hz", "frame", "positions": [N][2] m, "mu_static", "mu_kinetic", "k_normal", "k_tangential": [N],
//  "touch_s", "micro_onset_s", "onset_s": [N] (null: never), "time": packed, "stride",
//  "states": {"unit", "strict", "micro", "paper", "seen": packed}, "curves": [...], "channels": [...],
//  "spectra": spectra_of()}.
// "seen" is what the loop saw of the detector: there when `control` is not null and reads this sensor.
// A curve is {"key", "origin": "labels" or "sensor", "unit", "components", "per_unit", "data"}: `data` has a column for each unit
// and component, the unit running slowest, and row r belongs to time[r * stride].
// Of a sensor's channels those that hold the same values for each unit are curves.
// "channels": the others, as {"key", "unit", "names": one a value, "time": packed, "data": packed, a column a value}: rows have times of their
// own, of which every so many-th is kept where a channel has more than `curve_values` values.
// States are kept in full. When the curves have more than `curve_values` values in all, every stride-th row is kept.
Json trial_payload(const SensorRecord& sensor, const ControlRecord* control, std::size_t curve_values);

// SensorView of a type as the page reads it: {"unit", "units", "letter", "first", "from_behind", "orientation",
//  "channels": {key: {"name", "note"}}, "picture": null or {"channel", "cells", "width", "rest": null or a number, "falls", "note"}}.
Json view_payload(const std::string& type);

// {"dropped", "not_lifted", "lift_m", "drop_s", "slip_m", "rotation_rad", "max_force_N", "final_force_N", "ideal_force_N", "reaction_s"}: null: never, or
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

// Turns one drawn value into {"value": number in SI, "unit": SI symbol} or {"text": ...}. Text such as "4 mm/s" becomes a number.
// An infinite number, which JSON does not have, is {"value": null, "unit"}. A bare number takes the unit of the scene key that ends `path` ("motion.speed": m/s), "" where the key is not known.
Json plain_value(const std::string& path, const Json& drawn);

// The axes of the sweep: every path of any trial, in the order of first appearance, as
// {"path", "unit", "numeric": every trial that has it has a number, "varied": not the same in all trials}.
// `trials`: each {path: plain_value}.
Json axes(const std::vector<Json>& trials);

// Every parameter of the entries grip, box, scatter (where the scene has it), of the motion `lift`, of `contact` with fidelity
// mujoco_contact, and the surface's material:
// [{"path": "grip.stiffness", "value": as a scene writes it, "by": "scene" (or the command line), "sweep", "protocol" or "default", "doc",
//   "source", "assumed": the source says so}].
// `scene`: the text of a scene file with a grasp. `overrides`: {path: YAML text} of the command line. `swept`: object whose keys are the swept
// paths; their value is "". `place` names the scene in messages. Throws InputError when the overrides do not fit the scene.
Json grasp_parameters(const std::string& scene, const Json& overrides, const Json& swept, const std::string& place);

// [{"name", "unit", "window_s", "bin_hz", "time": packed, of the windows' ends, "data": packed, a row a window, a column a bin
// from 0 Hz on}]: of each channel for which the sensor's entry asks for one (SensorView). Values are magnitudes of
// detectors/nib/features.h. A spectrogram has at most `most_values` values: windows are then further apart. Recordings shorter than a
// window have none.
Json spectra_of(const SensorRecord& sensor, std::size_t most_values);

// The page of a dataset without truth, which holds imported recordings: what they are, all of them in a table with duration, rate, longest
// step, missing values and recorded labels, and the signals of some over time. `file`: its name, as the page shows it. `options.trial`: the
// recording whose channels are all drawn; empty: the first channels of `options.max_trials` recordings at most (default: 12), spread evenly.
// Throws InputError where a trial cannot be read.
std::string recordings_body(const DatasetReader& dataset, const std::string& file, const ReportOptions& options);

}  // namespace slipbench::report
