// Numbered work in child processes, whose results come back in order.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/workers/child_process.h"

namespace slipbench {

// As OrderedWorkers, with a child process for each work in place of threads: each begins with the memory of this process as it is at that time, and
// leaves nothing to the next. Only a few results wait at a time.
class OrderedChildren {
 public:
  // Does work(0) to work(count - 1), up to `jobs` at a time. `limit`: s that one may take; `fork`: see ChildProcesses. Once `interrupt` is true, which
  // may be null, no further work begins, and next() waits for none.
  OrderedChildren(std::size_t count, std::size_t jobs, std::function<std::string(std::size_t)> work,
                  const std::atomic<bool>* interrupt, double limit = std::numeric_limits<double>::infinity(), Fork fork = {});

  // Whether next() would return at once; waits for that until `deadline`.
  bool ready_until(std::chrono::steady_clock::time_point deadline);
  // How the next one ended; empty after the last, and once interrupted.
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
