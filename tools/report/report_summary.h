// The overview of a dataset: a row a trial, the axes of its sweep.
#pragma once

#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/dataset/record/trial_record.h"

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

// Converts one drawn value to {"value": number in SI, "unit": SI symbol} or {"text": ...}. Text
// such as "4 mm/s" becomes a number. An infinite number, which JSON lacks, becomes {"value": null,
// "unit"}. A plain number gets the unit of the scene key at the end of `path` ("motion.speed":
// m/s), "" for an unknown key.
Json plain_value(const std::string& path, const Json& drawn);

// The axes of the sweep: every path of any trial, in the order of first appearance, as {"path",
// "unit", "numeric": a number in every trial that has it, "varied": not equal in all trials}.
// `trials`: each {path: plain_value}.
Json axes(const std::vector<Json>& trials);

}  // namespace slipbench::report
