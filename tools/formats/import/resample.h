// Resamples a recording to an even rate: `slipbench import --rate`.
#pragma once

#include <cstddef>
#include <string>

#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Origin of the new samples, of the sensor with the most of each kind.
struct NewSamples {
  std::size_t in_gaps = 0;  // in steps of more than 1.5 median steps
  // Between recorded samples, if the rate is more than 1 % above the mean and the median rate of the
  // recording, so that samples are made up; else 0.
  std::size_t made_up = 0;
  double recorded_rate = 0.0;  // Hz, the greater of these two rates
};

// Samples every sensor of a recording at intervals 1/`rate` [Hz] from its first stamp to its last:
// values by linear interpolation without a filter, state_paper by the latest sample. Throws
// InputError, beginning with `place`, for a recording without a rate.
NewSamples resample(TrialRecord& record, double rate, const std::string& place);

}  // namespace slipbench
