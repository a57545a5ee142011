// Worker threads whose results come back in order.
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

// Does work 0, 1, ... count-1 on several threads and hands over the results in this order, whichever is ready first. Only a few
// results wait at a time, so that memory does not grow with `count`.
template <class Result>
class OrderedWorkers {
 public:
  using Work = std::function<Result(std::size_t)>;

  // Each thread calls `make_work` once, when it begins its first work, and then its work. `interrupt` may be null; once true, no
  // further work is begun. Throws InputError when the system does not give that many threads; then no work has begun.
  OrderedWorkers(std::size_t count, std::size_t threads, std::function<Work()> make_work, const std::atomic<bool>* interrupt)
      : count_(count), make_work_(std::move(make_work)), interrupt_(interrupt), active_(threads), ready_(2 * threads + 2) {
    const std::lock_guard lock(mutex_);  // holds the first threads back until there are all
    try {
      threads_.reserve(threads);
      while (threads_.size() < threads) threads_.emplace_back([this] { run(); });
    } catch (const std::system_error& error) {
      stopped_ = true;
      throw InputError("only " + std::to_string(threads_.size()) + " of " + std::to_string(threads) +
                       " worker threads could be started (" + error.code().message() + "); allowed: fewer, with --jobs");
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }
  // Waits for the work that has begun; begins no other.
  ~OrderedWorkers() {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
  }
  OrderedWorkers(const OrderedWorkers&) = delete;
  OrderedWorkers& operator=(const OrderedWorkers&) = delete;

  // Whether next() would return at once; waits for that until `deadline`.
  bool ready_until(std::chrono::steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(lock, deadline, [&] { return place_of(delivered_).has_value() || active_ == 0; });
  }

  // The next result; empty after the last one, or after the last that had begun before the interrupt. Rethrows what the work, or
  // the making of it, threw; no further work is begun after that.
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

  // Lets a worker destroy the result, before its next work. Memory that the caller frees here and allocates anew for something
  // that stays would keep the memory around it in the workers' heaps, which is many times its own: threads have heaps of their
  // own, and each hands out again what it has freed last, whosever it was.
  void give_back(Result result) {
    const std::lock_guard lock(mutex_);
    spent_.push_back(std::move(result));
  }

 private:
  struct Outcome {
    std::optional<Result> result;
    std::exception_ptr error;
  };

  // What the making and the work throw reaches the caller.
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
        if (outcome.error) stopped_ = true;  // all work before it has begun: none other can be the first to fail
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

  // Work runs ahead of what is delivered by no more than there are places, so that each has one of its own.
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

  std::vector<std::jthread> threads_;  // last: joined before the rest is destroyed
};

}  // namespace slipbench
