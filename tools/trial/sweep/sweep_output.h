// The dataset of a running sweep.
#pragma once

#include <cstddef>
#include <exception>
#include <memory>

#include "tools/dataset/batches.h"
#include "tools/dataset/header.h"
#include "tools/dataset/record/encoder.h"
#include "tools/trial/sweep/run_sweep.h"
#include "tools/trial/sweep/sweep_queue.h"
#include "tools/trial/sweep/trial_workers.h"

namespace slipbench {

// Writes the trials of a sweep to its dataset, or drops them if the sweep has no output. Throws
// InputError if anything cannot be written.
class SweepOutput {
 public:
  // Creates the folder for finished work.
  SweepOutput(const SweepOptions& options, const DatasetHeader& header);

  // With options.resume, reads what an earlier run left: gives its trials to `queue`, and lists
  // damaged batches in `summary`. Returns false if that run was complete, so that nothing is left to
  // do; `summary` then describes its dataset. Without, throws InputError if an earlier run left
  // anything.
  bool open(SweepQueue& queue, SweepSummary& summary);

  // Finishes the current batch if its time is over, or will be before `workers` have a trial.
  void finish_due_batch(TrialWorkers& workers);
  void append(const FinishedTrial& trial);
  void add_failed(const FailedTrial& failed);
  // Writes the dataset if `whole`, and otherwise keeps the batches. Lists the files in `summary`.
  void finish(bool whole, SweepSummary& summary);

  // In a handler of `error`, after a failure of the sweep: keeps the finished trials, and throws the
  // error again with the folder that contains them. `planned`: number of trials of the sweep.
  [[noreturn]] void fail(const std::exception& error, std::size_t planned);

 private:
  const SweepOptions& options_;
  DatasetHeader header_;
  std::unique_ptr<SweepWriter> writer_;  // null: no output
};

}  // namespace slipbench
