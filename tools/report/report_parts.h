// Parts of the page's data: the overview of a dataset, and the drawings of a trial.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/report/report.h"

namespace slipbench {
class DatasetReader;
}

namespace slipbench::report {

inline constexpr float at_rest = 1e-6F;  // m/s or rad/s: slower prescribed motion is rounding

// Each number, or null if it is not finite.
Json numbers_or_null(const std::vector<double>& values);

// First touch of each unit [s]; NaN: never.
std::vector<double> touch_times(const LabelRecord& labels);

// Throws InputError if the labels hold an unknown state, unit or kind of event, no sample, or a
// time that is not finite. `place` names the trial in the message.
void check_labels(const SensorRecord& sensor, const std::string& place);

// Time [s] of the first lateral (world x, y) or rotational motion of any body of the trial at or
// after `from` [s]; NaN if there is none. A press along z does not count.
double motion_start(const TrialRecord& trial, double from);

// {"units", "shares": {"strict": [4], "micro": [4], "paper": [4]} (share of the samples in each
// state),
//  "first_touch_s", "first_micro_s", "first_full_s", "gross_s" (rule strict, resolved inside the
//  step by the slip event that completes it), "incipient_s" (duration from first_micro_s to
//  gross_s), "max_slip_m", "disagreement": {"paper", "micro"} (share of the samples in contact
//  where that rule differs from strict)}.
// null means never.
Json summarise(const SensorRecord& sensor);

// {"name", "type", "rate_hz", "frame", "positions": [N][2] m, "mu_static", "mu_kinetic",
// "k_normal", "k_tangential": [N],
//  "touch_s", "micro_onset_s", "onset_s": [N] (null: never), "time": packed, "stride",
//  "states": {"unit", "strict", "micro", "paper", "seen": packed}, "curves": [...], "channels":
//  [...],
//  "spectra": spectra_of()}.
// "seen" is the detector's answer in the loop: present if `control` is not null and reads this
// sensor. A curve is {"key", "origin": "labels" or "sensor", "unit", "components", "per_unit",
// "data"}: `data` has a column for each unit and component, units outermost, and row r is at time[r
// * stride]. A channel is a curve if it has the same values for each unit.
// "channels": the others, as {"key", "unit", "names": one per value, "time": packed, "data":
// packed, one column per value}: rows have their own times, and are thinned if a channel has more
// than `curve_values` values. States are complete. If the curves have more than `curve_values`
// values in total, every stride-th row is kept.
Json trial_payload(const SensorRecord& sensor, const ControlRecord* control, std::size_t curve_values);

// SensorView of a type for the page: {"unit", "units", "letter", "first", "from_behind",
// "orientation",
//  "channels": {key: {"name", "note"}}, "picture": null or {"channel", "cells", "width", "rest":
//  null or a number, "falls", "note"}}.
Json view_payload(const std::string& type);

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

// Converts one drawn value to {"value": number in SI, "unit": SI symbol} or {"text": ...}. Text
// such as "4 mm/s" becomes a number. An infinite number, which JSON lacks, becomes {"value": null,
// "unit"}. A plain number gets the unit of the scene key at the end of `path` ("motion.speed":
// m/s), "" for an unknown key.
Json plain_value(const std::string& path, const Json& drawn);

// The axes of the sweep: every path of any trial, in the order of first appearance, as {"path",
// "unit", "numeric": a number in every trial that has it, "varied": not equal in all trials}.
// `trials`: each {path: plain_value}.
Json axes(const std::vector<Json>& trials);

// Every parameter of the entries grip, box, scatter (if the scene has it), of the motion `lift`, of
// `contact` with fidelity mujoco_contact, and the surface's material:
// [{"path": "grip.stiffness", "value": as in a scene, "by": "scene" (or the command line), "sweep",
// "protocol" or "default", "doc", "source", "assumed": according to its source}].
// `scene`: text of a scene file with a grasp. `overrides`: {path: YAML text} of the command line.
// `swept`: object whose keys are the swept paths; their value is "". `place` names the scene in
// messages. Throws InputError if the overrides do not fit the scene.
Json grasp_parameters(const std::string& scene, const Json& overrides, const Json& swept, const std::string& place);

// [{"name", "unit", "window_s", "bin_hz", "time": packed, of the windows' ends, "data": packed, one
// row per window, one column per bin from 0 Hz}]: of each channel for which the sensor's entry
// requests one (SensorView). Values are magnitudes of detectors/nib/features.h. A spectrogram has
// at most `most_values` values; if necessary, windows are further apart. Recordings shorter than a
// window have none.
Json spectra_of(const SensorRecord& sensor, std::size_t most_values);

// The page of a dataset without truth, which holds imported recordings: their source, a table of
// all with duration, rate, longest step, missing values and recorded labels, and the signals of
// some over time. `file`: its name on the page. `options.trial`: the recording whose channels are
// all drawn; empty: the first channels of at most `options.max_trials` recordings (default: 12),
// evenly spaced. Throws InputError if a trial is unreadable.
std::string recordings_body(const DatasetReader& dataset, const std::string& file, const ReportOptions& options);

}  // namespace slipbench::report
