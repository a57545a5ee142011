// A recording at an even rate in place of the recorder's own instants: `slipbench import --rate`.
#pragma once

#include <cstddef>
#include <string>

#include "tools/base/record/trial_record.h"

namespace slipbench {

// Samples every sensor of a recording 1/`rate` [Hz] apart, from its first stamp to its last one: values on the straight lines between neighbouring samples, without
// a filter; of state_paper the latest. Returns how many of the new samples lie in gaps, steps of more than 1.5 median steps. Throws InputError, which
// begins with `place`, for a recording without a rate and for a rate above both mean and median rate by more than 1 %.
std::size_t resample(TrialRecord& record, double rate, const std::string& place);

}  // namespace slipbench
