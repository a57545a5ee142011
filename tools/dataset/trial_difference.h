// Compares two computations of one trial.
#pragma once

#include <string>

#include "tools/dataset/record/trial_record.h"

namespace slipbench {

// Relative difference up to which two numbers are equal if third-party libraries computed them:
// their rounding depends on the processor.
inline constexpr double library_rounding = 1e-9;

// Compares two computations of one trial whose digests differ. Only trials that name `libraries`
// (TrialRecord::libraries) may differ. Two numbers are equal if they differ by at most
// `library_rounding` of the larger one or of the largest in the array, and by one unit in the last
// place of a float32. Values that are zero except for rounding, such as slip_angle and slip_centre
// without motion, are thus compared by their distance, and slip_direction by its angle. Returns the
// first difference as a clause; empty if they agree.
std::string trial_difference(const TrialRecord& one, const TrialRecord& other);

// True if two numbers agree by that rule; `scale`: the largest magnitude in their array.
bool agree(double one, double other, double scale, double last_place = 0.0);

}  // namespace slipbench
