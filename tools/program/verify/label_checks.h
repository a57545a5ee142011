// What the arrays of a trial must be to each other.
#pragma once

#include "tools/base/record/trial_record.h"
#include "tools/program/verify/verification.h"

namespace slipbench::verify {

// Times rise strictly, those of a sensor at its rate to 1e-6 of a sample.
void check_times(const TrialRecord& record, Verification& verification);

// Finite, but for what README.md of tools/base/dataset allows NaN: where nothing touches or slips.
void check_values(const TrialRecord& record, Verification& verification);

// Events in order, onset times the first events, unit_state what the events leave behind, the pad's states what the units' are.
void check_events(const SensorRecord& sensor, std::size_t trial, Verification& verification);

}  // namespace slipbench::verify
