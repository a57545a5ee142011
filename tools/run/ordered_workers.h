// Worker threads whose results come back in order.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace slipbench {

// Does work 0, 1, ... count-1 on several threads and hands over the results in this order, whichever is ready first. Only a few
// results wait at a time, so that memory does not grow with `count`.
template <class Result>
class OrderedWorkers {
 public:
  using Work = std::function<Result(std::size_t)>;

  // Each thread calls `make_work` once and then its work. `interrupt` may be null; once true, no further work is begun.
  OrderedWorkers(std::size_t count, std::size_t threads, std::function<Work()> make_work, const std::atomic<bool>* interrupt)
      : count_(count), window_(2 * threads + 2), make_work_(std::move(make_work)), interrupt_(interrupt), active_(threads) {
    for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
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

  // The next result; empty after the last one, or after the last that had begun before the interrupt. Rethrows what the work
  // threw.
  std::optional<Result> next() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ready_.contains(delivered_) || active_ == 0; });
    auto node = ready_.extract(delivered_);
    if (node.empty()) return std::nullopt;
    ++delivered_;
    lock.unlock();
    changed_.notify_all();
    if (node.mapped().error) std::rethrow_exception(node.mapped().error);
    return std::move(node.mapped().result);
  }

 private:
  struct Outcome {
    std::optional<Result> result;
    std::exception_ptr error;
  };

  void run() {
    const Work work = make_work_();
    while (const std::optional<std::size_t> index = claim()) {
      Outcome outcome;
      try {
        outcome.result = work(*index);
      } catch (...) {
        outcome.error = std::current_exception();
      }
      {
        const std::lock_guard lock(mutex_);
        ready_.emplace(*index, std::move(outcome));
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
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return ended() || claimed_ < delivered_ + window_; });
    if (ended()) return std::nullopt;
    return claimed_++;
  }

  [[nodiscard]] bool ended() const { return stopped_ || claimed_ == count_ || (interrupt_ != nullptr && interrupt_->load()); }

  std::size_t count_;
  std::size_t window_;
  std::function<Work()> make_work_;
  const std::atomic<bool>* interrupt_;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t claimed_ = 0;
  std::size_t delivered_ = 0;
  std::size_t active_;
  bool stopped_ = false;
  std::map<std::size_t, Outcome> ready_;

  std::vector<std::jthread> threads_;  // last: joined before the rest is destroyed
};

}  // namespace slipbench
