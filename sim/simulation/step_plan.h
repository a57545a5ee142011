// How a trial's time is cut into steps and samples, and when each of its pads is due.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/scene.h"

namespace slipbench {

struct StepPlan {
  double dt = 0.0;                   // s
  std::size_t ticks = 0;             // duration / dt
  std::vector<std::size_t> strides;  // ticks between two samples, by sensor
};

// The steps that the sensors of a scene from number `first` on have in common, which sample at `output_rates` [Hz]. `time_step: auto` takes the longest step that divides every
// sampling time and is at most `longest` [s]. `limited_by` says what does not bear a longer one: "the scene's effects".
// Throws SceneValueError when the scene's own step is longer than that, is no whole part of the duration or of a sampling time.
StepPlan plan_steps(const Scene& scene, std::span<const double> output_rates, double longest, const std::string& limited_by,
                    std::size_t first = 0);

// Tick k of a clock with the given step [s] is at k/n where the step is an nth of a second up to the rounding of decimal text, and else at
// k steps. A quotient of whole numbers is rounded once, so that ticks of different clocks that are at the same time are so to the bit:
// 9 ms is 9/1000 and 90/10000, but not 9 times 0.001.
class TickTimes {
 public:
  explicit TickTimes(double step) : step_(step) {
    constexpr double rounding = 1e-12;
    const double nearest = std::round(1.0 / step);
    if (std::abs(nearest * step - 1.0) <= rounding) per_second_ = nearest;
  }

  [[nodiscard]] double at(std::size_t tick) const {
    const auto k = static_cast<double>(tick);
    return per_second_ > 0.0 ? k / per_second_ : k * step_;
  }

 private:
  double step_;
  double per_second_ = 0.0;  // 0: the step is no whole part of a second
};

// A pad ticks at the times of its own step, to the bit as without the others; no common clock is sought, so any rates go together. Where
// pads tick at the same time they do so to the bit.
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
