// Simulates the trials of a sweep, on threads or in child processes.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim/scene/parser.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sweep/finished_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/sweep_shard.h"

namespace slipbench {

// Recorded part of a trial; without a dataset, the outcome.
Recording recording_of(const SweepOptions& options);

// Parameters for running and recording the trials.
struct WorkPlan {
  const TrialPlan& trials;
  std::uint64_t seed = 0;
  Recording recording = Recording::full;
  double max_bytes = max_record_bytes;  // of a trial's record
  const std::atomic<bool>* interrupt = nullptr;
  std::atomic<double>* share = nullptr;  // of the trial that is simulated; null: not reported
};

// Simulates trials and returns them in order.
class TrialWorkers {
 public:
  TrialWorkers() = default;
  virtual ~TrialWorkers() = default;
  TrialWorkers(const TrialWorkers&) = delete;
  TrialWorkers& operator=(const TrialWorkers&) = delete;

  // True if next() would return at once; waits for that until `deadline`.
  virtual bool ready_until(std::chrono::steady_clock::time_point deadline) = 0;
  // The next trial, which may have failed. Empty after the last trial, and once interrupted. Throws
  // InputError if a file that the trials read has changed.
  virtual std::optional<FinishedTrial> next() = 0;
  // Takes back a trial that is no longer needed.
  virtual void give_back(FinishedTrial trial) = 0;
};

// Starts `jobs` workers on the trials of the numbers `trials`: threads, or, if isolated, a child
// process for each trial. `plan.trials`, `options` and `files`, the files that the trials read, must
// outlive the result.
std::unique_ptr<TrialWorkers> make_workers(std::vector<std::size_t> trials, std::size_t jobs, const WorkPlan& plan,
                                           const SweepOptions& options, const HeldFiles& files);

}  // namespace slipbench
