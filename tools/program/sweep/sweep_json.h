// A sweep as numbers for programs.
#pragma once

#include <string>

#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

// A trial as an element of `trials` in the one JSON object of `--json`, and the rest of that object.
std::string trial_json(const TrialSummary& trial);
std::string summary_json(const SweepSummary& summary);

}  // namespace slipbench
