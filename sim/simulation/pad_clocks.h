// The clocks of pads that do not feel each other: each ticks as it would alone.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "sim/simulation/step_plan.h"
#include "sim/simulation/tick_times.h"

namespace slipbench {

// A pad ticks at the times of its own step, to the bit as without the others; no common clock is sought, so any rates go together. Where
// pads tick at the same time they do so to the bit (tick_times.h).
class PadClocks {
 public:
  // The next pad's. `plan`: of that pad alone.
  void add(const StepPlan& plan) {
    clocks_.push_back({plan.dt, plan.ticks, plan.strides.front(), TickTimes(plan.dt)});
    stepped_.reserve(clocks_.size());
  }

  // Goes to the next instant at which a pad has a tick and returns it [s]; the first is 0.
  double advance() {
    double now = clocks_.front().due;
    for (const Clock& clock : clocks_) now = std::min(now, clock.due);
    stepped_.clear();
    for (std::size_t pad = 0; pad < clocks_.size(); ++pad) {
      Clock& clock = clocks_[pad];
      if (clock.due != now) continue;
      clock.due = clock.times.at(++clock.tick);
      stepped_.push_back(pad);
    }
    return now;
  }

  // The pads that have a tick at the instant last gone to, in ascending order.
  [[nodiscard]] std::span<const std::size_t> stepped() const { return stepped_; }
  [[nodiscard]] std::size_t ticks(std::size_t pad) const { return clocks_[pad].ticks; }
  [[nodiscard]] double time_step(std::size_t pad) const { return clocks_[pad].dt; }  // s
  [[nodiscard]] std::size_t stride(std::size_t pad) const { return clocks_[pad].stride; }

 private:
  struct Clock {
    double dt;  // s
    std::size_t ticks, stride;
    TickTimes times;
    std::size_t tick = 0;  // the next one
    double due = 0.0;      // s, its time
  };
  std::vector<Clock> clocks_;
  std::vector<std::size_t> stepped_;
};

}  // namespace slipbench
