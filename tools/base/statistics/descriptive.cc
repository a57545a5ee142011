#include "tools/base/statistics/descriptive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

MeanSd mean_sd(std::span<const double> values) {
  if (values.empty()) return {nan, nan};
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, values.size() < 2 ? nan : std::sqrt(squares / (n - 1.0))};
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return nan;
  std::ranges::sort(values);
  const double place = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - std::floor(place)) * (values[above] - values[below]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

Interval median_interval(std::vector<double> values) {
  std::ranges::sort(values);
  std::size_t r = 0;
  while (r < values.size() && clopper_pearson(r, values.size()).high <= 0.5) ++r;
  return r == 0 ? Interval{nan, nan} : Interval{values[r - 1], values[values.size() - r]};
}

}  // namespace slipbench
