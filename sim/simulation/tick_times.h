// When a tick is.
#pragma once

#include <cmath>
#include <cstddef>

namespace slipbench {

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

}  // namespace slipbench
