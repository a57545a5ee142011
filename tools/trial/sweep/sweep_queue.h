// The trials that a sweep has to run.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/trial/sweep/finished_trial.h"
#include "tools/trial/sweep/run_sweep.h"

namespace slipbench {

// Numbers of the trials of a run, ascending, and the results of those that an earlier run finished.
class SweepQueue {
 public:
  // Throws InputError if there are fewer trials than shards.
  SweepQueue(const ReadSweep& read, const SweepOptions& options);

  // Trials that an earlier run finished, as messages (finished_trial.h).
  void resume(std::map<std::size_t, std::string> finished) { finished_ = std::move(finished); }

  [[nodiscard]] const std::vector<std::size_t>& trials() const { return trials_; }
  // Those of trials() that no earlier run finished.
  [[nodiscard]] std::vector<std::size_t> missing() const;
  // The result of a trial that an earlier run finished; empty: this run simulates it.
  [[nodiscard]] std::optional<FinishedTrial> finished(std::size_t trial) const;

 private:
  std::vector<std::size_t> trials_;
  std::map<std::size_t, std::string> finished_;
};

}  // namespace slipbench
