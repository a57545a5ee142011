// A trial of a sweep as a worker hands it over.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tools/base/record/encoder.h"
#include "tools/program/sweep/run_sweep.h"

namespace slipbench {

struct FinishedTrial {
  TrialSummary summary;
  double duration = 0.0;                // s, simulated
  double computed = 0.0;                // s, on the clock
  double time_step = 0.0;               // s
  std::optional<EncodedTrial> encoded;  // empty: no dataset is written
  std::string failure = {};             // why the trial failed; empty: it did not
};

// The trial as MessagePack, for its way out of the process that has simulated it.
std::string to_message(const FinishedTrial& trial);
// The inverse. Throws std::runtime_error where `message` does not hold a trial.
FinishedTrial from_message(std::string_view message);

}  // namespace slipbench
