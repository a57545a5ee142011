#include "tools/workers/ordered_children.h"

#include <algorithm>
#include <utility>

namespace slipbench {

using Clock = std::chrono::steady_clock;

OrderedChildren::OrderedChildren(std::size_t count, std::size_t jobs, std::function<std::string(std::size_t)> work,
                                 const std::atomic<bool>* interrupt, double limit, Fork fork)
    : count_(count),
      jobs_(std::max<std::size_t>(jobs, 1)),
      work_(std::move(work)),
      interrupt_(interrupt),
      children_(limit, std::move(fork)),
      ready_(2 * jobs_ + 2) {}

void OrderedChildren::start_more() {
  while (!interrupted() && started_ < std::min(count_, delivered_ + ready_.size()) && children_.running() < jobs_) {
    children_.start(started_, [this] { return work_(started_); });
    ++started_;
  }
}

bool OrderedChildren::ready_until(Clock::time_point deadline) {
  constexpr std::chrono::milliseconds between_looks{50};  // polling period of the interrupt
  while (true) {
    start_more();
    if (delivered_ == count_ || interrupted() || place_of(delivered_)) return true;
    if (auto ended = children_.wait_until(std::min(deadline, Clock::now() + between_looks))) {
      place_of(ended->first) = std::move(ended->second);
    } else if (Clock::now() >= deadline) {
      return false;
    }
  }
}

std::optional<ChildEnd> OrderedChildren::next() {
  ready_until(Clock::time_point::max());
  if (delivered_ == count_ || interrupted()) return std::nullopt;
  std::optional<ChildEnd> end = std::exchange(place_of(delivered_), std::nullopt);
  ++delivered_;
  return end;
}

}  // namespace slipbench
