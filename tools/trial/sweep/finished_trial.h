// Result of a trial that a worker returns.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "tools/dataset/record/encoder.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

struct FinishedTrial {
  TrialSummary summary;
  double duration = 0.0;                // s, simulated
  double computed = 0.0;                // s, wall-clock time
  double time_step = 0.0;               // s
  std::optional<EncodedTrial> encoded;  // empty: no dataset is written
  std::string failure = {};             // reason of a failure; empty: success
};

// Returns the result of a trial that failed with the message `why`.
FinishedTrial failed_trial(std::size_t trial, const std::string& why);

// Returns the summary of a trial. Moves the outcomes of the units out of `result`.
TrialSummary summary_of(TrialResult& result);

// Serialises the trial as MessagePack, for the transfer from the process that simulated it.
std::string to_message(const FinishedTrial& trial);
// Inverse of to_message(). Throws std::runtime_error if `message` is invalid.
FinishedTrial from_message(std::string_view message);

}  // namespace slipbench
