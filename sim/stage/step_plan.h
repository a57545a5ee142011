// Divides a trial's time into steps and samples, and says when each pad has a tick.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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

// The longest step that the physics of a scene allows, and its cause for messages: "the scene's
// effects".
struct StepLimit {
  double longest = std::numeric_limits<double>::infinity();  // s
  std::string cause = {};
};

// Plans the common steps of a scene's sensors from number `first` on, which sample at
// `output_rates` [Hz]. `time_step: auto` takes the longest step that divides every sampling time
// and is within `limit`. Throws SceneValueError if the scene's own step is longer than that, does
// not divide the duration or a sampling time, or if the trial would have more than max_steps steps.
StepPlan plan_steps(const Scene& scene, std::span<const double> output_rates, const StepLimit& limit, std::size_t first = 0);

// Times of a clock's ticks. If the step [s] is 1/n of a second, up to the rounding of decimal text,
// tick k is at k/n; otherwise at k steps. A quotient of whole numbers is rounded once, so that
// simultaneous ticks of different clocks have bit-identical times: 9 ms is 9/1000 and 90/10000, but
// not 9 times 0.001.
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
  double per_second_ = 0.0;  // 0: the step does not divide a second
};

// Clocks of several pads. A pad ticks at the times of its own step, bit-identical to those without
// other pads. There is no common clock, so any rates can be combined. Simultaneous ticks of pads
// have bit-identical times.
class PadClocks {
 public:
  // Adds the next pad. `plan`: of that pad alone.
  void add(const StepPlan& plan) {
    clocks_.push_back({plan.dt, plan.ticks, plan.strides.front(), TickTimes(plan.dt)});
    stepped_.reserve(clocks_.size());
  }

  // Advances to the next instant at which a pad has a tick and returns it [s]; the first is 0.
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

  // The pads with a tick at the current instant, in ascending order.
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
