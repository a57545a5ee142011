// What the overview says of one sensor in one trial, in a few numbers.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/json.h"
#include "tools/base/record/trial_record.h"

namespace slipbench::report {

inline constexpr float at_rest = 1e-6F;  // m/s or rad/s: below this a prescribed motion only rounds

// A number, or null when it is not finite.
Json number_or_null(double value);
Json numbers_or_null(const std::vector<double>& values);

// Values of a channel in one sample.
std::size_t row_size(const SensorColumn& channel);

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

}  // namespace slipbench::report
