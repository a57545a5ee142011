// Runs work on threads and returns the results in order.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "sim/core/error.h"

namespace slipbench {

// Runs work 0, 1, ... count-1 on several threads and returns the results in this order. Few results
// wait at a time, so that memory does not grow with `count`.
template <class Result>
class OrderedWorkers {
 public:
  using Work = std::function<Result(std::size_t)>;

  // Each thread calls `make_work` once, before its first work item, and then the work. `interrupt`
  // may be null; once true, no further work starts. Throws InputError if the system cannot create
  // that many threads; then no work has started.
  OrderedWorkers(std::size_t count, std::size_t threads, std::function<Work()> make_work, const std::atomic<bool>* interrupt)
      : count_(count), make_work_(std::move(make_work)), interrupt_(interrupt), active_(threads), ready_(2 * threads + 2) {
    const std::lock_guard lock(mutex_);  // holds the first threads back until all exist
    try {
      threads_.reserve(threads);
      while (threads_.size() < threads) threads_.emplace_back([this] { run(); });
    } catch (const std::system_error& error) {
      stopped_ = true;
      throw InputError("only " + std::to_string(threads_.size()) + " of " + std::to_string(threads) +
                       " worker threads could be started (" + error.code().message() + "); use fewer, with --jobs");
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }
  // Waits for started work; starts no other.
  ~OrderedWorkers() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
  }
  OrderedWorkers(const OrderedWorkers&) = delete;
  OrderedWorkers& operator=(const OrderedWorkers&) = delete;

  // True if next() would return at once; waits for that until `deadline`.
  bool ready_until(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(lock, deadline, [&] { return place_of(delivered_).has_value() || active_ == 0; });
  }

  // The next result; empty after the last one, or after the last one started before the interrupt.
  // Rethrows the exception of the work or of `make_work`; no further work starts then.
  std::optional<Result> next() {
    std::unique_lock lock(mutex_);
    std::optional<Outcome>& place = place_of(delivered_);
    changed_.wait(lock, [&] { return place.has_value() || active_ == 0; });
    if (!place) return std::nullopt;
    Outcome outcome = *std::exchange(place, std::nullopt);
    ++delivered_;
    lock.unlock();
    changed_.notify_all();
    if (outcome.error) std::rethrow_exception(outcome.error);
    return std::move(outcome.result);
  }

  // Lets a worker destroy the result before its next work. If the caller freed it here and reused
  // the memory for something permanent, the surrounding memory in the workers' heaps, many times as
  // much, would stay allocated: each thread has its own heap, which hands out first what was freed
  // last, by any thread.
  void give_back(Result result) {
    const std::lock_guard lock(mutex_);
    spent_.push_back(std::move(result));
  }

 private:
  struct Outcome {
    std::optional<Result> result;
    std::exception_ptr error;
  };

  // Exceptions of `make_work` and of the work reach the caller.
  void run() {
    Work work;
    while (const std::optional<std::size_t> index = claim()) {
      Outcome outcome;
      try {
        if (!work) work = make_work_();
        outcome.result = work(*index);
      } catch (...) {
        outcome.error = std::current_exception();
      }
      {
        const std::lock_guard lock(mutex_);
        if (outcome.error) stopped_ = true;  // all earlier work has started, so no other can fail first
        place_of(*index) = std::move(outcome);
      }
      changed_.notify_all();
    }
    {
      const std::lock_guard lock(mutex_);
      --active_;
    }
    changed_.notify_all();
  }

  std::optional<std::size_t> claim() {
    std::vector<Result> spent;  // destroyed after the lock
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ended() || claimed_ < delivered_ + ready_.size(); });
    if (ended()) return std::nullopt;
    spent.swap(spent_);
    return claimed_++;
  }

  // Work runs ahead of delivery by no more than ready_.size(), so that each item has its own slot.
  std::optional<Outcome>& place_of(std::size_t index) { return ready_[index % ready_.size()]; }

  [[nodiscard]] bool ended() const { return stopped_ || claimed_ == count_ || (interrupt_ != nullptr && interrupt_->load()); }

  std::size_t count_;
  std::function<Work()> make_work_;
  const std::atomic<bool>* interrupt_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t claimed_ = 0;
  std::size_t delivered_ = 0;
  std::size_t active_;
  bool stopped_ = false;
  std::vector<std::optional<Outcome>> ready_;
  std::vector<Result> spent_;

  std::vector<std::jthread> threads_;  // last: joined before the other members are destroyed
};

}  // namespace slipbench
