// Runs numbered work in child processes and returns the results in order.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tools/workers/child_process.h"

namespace slipbench {

// Like OrderedWorkers, with a child process per work item instead of threads: each starts with a
// copy of this process's current memory and passes nothing to the next. Few results wait at a time.
class OrderedChildren {
 public:
  // Runs work(0) to work(count - 1), up to `jobs` at a time. `limit`: time limit of each
  // [s]; `fork`: see ChildProcesses. Once `interrupt`, which may be null, is true, no further work
  // starts and next() does not wait.
  OrderedChildren(std::size_t count, std::size_t jobs, std::function<std::string(std::size_t)> work,
                  const std::atomic<bool>* interrupt, double limit = std::numeric_limits<double>::infinity(), Fork fork = {});

  // True if next() would return at once; waits for that until `deadline`.
  bool ready_until(std::chrono::steady_clock::time_point deadline);
  // End of the next work item; empty after the last one, and once interrupted.
  std::optional<ChildEnd> next();

 private:
  [[nodiscard]] bool interrupted() const { return interrupt_ != nullptr && *interrupt_; }
  std::optional<ChildEnd>& place_of(std::size_t index) { return ready_[index % ready_.size()]; }
  void start_more();

  std::size_t count_;
  std::size_t jobs_;
  std::function<std::string(std::size_t)> work_;
  const std::atomic<bool>* interrupt_;
  ChildProcesses children_;
  std::vector<std::optional<ChildEnd>> ready_;  // by index modulo its size
  std::size_t started_ = 0;
  std::size_t delivered_ = 0;
};

}  // namespace slipbench
