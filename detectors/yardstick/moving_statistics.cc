#include "detectors/yardstick/moving_statistics.h"

#include <algorithm>
#include <cmath>

namespace slipbench {

MovingStatistics::MovingStatistics(std::size_t frames, std::size_t size)
    : frames_(frames), past_(frames * size), first_(size), sum_(size), squares_(size) {}

void MovingStatistics::push(std::span<const float> values) {
  if (seen_ == 0) std::ranges::copy(values, first_.begin());
  const std::size_t size = first_.size();
  double* oldest = past_.data() + seen_ % frames_ * size;
  for (std::size_t i = 0; i < size; ++i) {
    const double value = values[i] - first_[i];
    sum_[i] += value - oldest[i];
    squares_[i] += value * value - oldest[i] * oldest[i];
    oldest[i] = value;
  }
  ++seen_;
}

double MovingStatistics::mean(std::size_t i) const { return first_[i] + sum_[i] / static_cast<double>(frames_); }

double MovingStatistics::deviation(std::size_t i) const {
  const auto n = static_cast<double>(frames_);
  const double mean = sum_[i] / n;
  return std::sqrt(std::max(0.0, squares_[i] / n - mean * mean));  // rounding may leave less than 0
}

double MovingStatistics::change(std::size_t i) const {
  const std::size_t size = first_.size();
  const std::size_t newest = (seen_ - 1) % frames_, earliest = seen_ % frames_;
  return past_[newest * size + i] - past_[earliest * size + i];
}

}  // namespace slipbench
