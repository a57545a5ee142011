// The results of a running sweep, and reports of its progress.
#pragma once

#include <atomic>
#include <cstddef>
#include <utility>

#include "tools/dataset/header.h"
#include "tools/trial/sweep/finished_trial.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/sweep_queue.h"
#include "tools/trial/sweep/trial_workers.h"

namespace slipbench {

// Collects the summary of a sweep, and calls the callbacks of its progress.
class SweepResults {
 public:
  // `read`, `options` and `progress`, which may be empty, must outlive the object.
  SweepResults(const ReadSweep& read, const SweepOptions& options, const SweepQueue& queue, const ProgressCallback& progress);

  [[nodiscard]] SweepSummary& summary() { return summary_; }
  [[nodiscard]] SweepSummary take_summary() { return std::move(summary_); }

  // Adds a trial that an earlier run finished.
  void add_resumed(FinishedTrial trial) { add_summary(trial.summary); }
  // Adds a trial that this run has simulated.
  void add(FinishedTrial& trial);
  // Adds a trial that failed, with the command that repeats it.
  const FailedTrial& add_failed(FinishedTrial& trial);
  // Determines whether the sweep was interrupted. Returns true if the dataset is to be written.
  bool close();

  // Reports the finished trials, if there are more than at the last report.
  void report();
  // Until the only trial of a sweep has ended, reports its simulated share.
  void report_share(TrialWorkers& workers, const std::atomic<double>& share) const;

 private:
  void add_summary(TrialSummary& summary);
  [[nodiscard]] std::size_t done() const { return summary_.trials.size() + summary_.failed.size(); }

  const SweepOptions& options_;
  const ProgressCallback& progress_;
  SweepSummary summary_;
  std::size_t reported_ = 0;  // number of finished trials at the last report
};

}  // namespace slipbench
