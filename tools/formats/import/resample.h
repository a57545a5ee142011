// Resamples a recording to an even rate: `slipbench import --rate`.
#pragma once

#include <cstddef>
#include <string>

#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Samples every sensor of a recording at intervals 1/`rate` [Hz] from its first stamp to its last:
// values by linear interpolation without a filter, state_paper by the latest sample. Returns the
// number of new samples in gaps, which are steps of more than 1.5 median steps. Throws InputError,
// beginning with `place`, for a recording without a rate and for a rate more than 1 % above both
// mean and median rate.
std::size_t resample(TrialRecord& record, double rate, const std::string& place);

}  // namespace slipbench
