#include "tools/dataset/record/sample_timing.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "sim/core/math/decade.h"

namespace slipbench {
namespace {

// Resolution plus the spacing of doubles at two stamps, each rounded when read and when scaled.
double whole_resolution(std::span<const double> times, double resolution) {
  const double largest = std::max(std::abs(times.front()), std::abs(times.back()));
  return resolution + 2.0 * std::numeric_limits<double>::epsilon() * largest;
}

double mean_step(std::span<const double> times) { return (times.back() - times.front()) / static_cast<double>(times.size() - 1); }

double median_step(std::span<const double> times) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < times.size(); ++k) steps.push_back(times[k] - times[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  if (steps.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(steps.begin(), middle));
}

// The value with the fewest significant digits within [low, high], the nearest to `value` if there
// are several; `value` if 15 digits are too few.
double roundest(double low, double value, double high) {
  constexpr int digits_of_a_double = 15;
  const int exponent = decade_of(value);
  for (int digits = 1; digits <= digits_of_a_double; ++digits) {
    const int place = digits - 1 - exponent;  // decimals
    const double unit = power_of_ten(std::abs(place));
    const auto decimal = [&](double whole) { return place >= 0 ? whole / unit : whole * unit; };
    const double whole = place >= 0 ? value * unit : value / unit;
    const double below = decimal(std::floor(whole)), above = decimal(std::ceil(whole));
    const bool below_fits = below >= low && below > 0.0, above_fits = above <= high;
    if (below_fits && above_fits) return value - below <= above - value ? below : above;
    if (below_fits) return below;
    if (above_fits) return above;
  }
  return value;
}

bool differ(double step, double mean, double resolution) { return std::abs(step - mean) > rate_tolerance * mean + resolution; }

}  // namespace

bool same_rate(double rate, double wanted) { return std::abs(rate - wanted) <= rate_tolerance * wanted; }

SampleTiming timing_of(std::span<const double> times, double resolution) {
  SampleTiming timing{.resolution = whole_resolution(times, resolution),
                      .mean_rate = 1.0 / mean_step(times),
                      .median_rate = 1.0 / median_step(times)};
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double step = times[k] - times[k - 1];
    if (step <= timing.largest_gap) continue;
    timing.largest_gap = step;
    timing.largest_gap_at = times[k - 1];
  }
  return timing;
}

double rate_of(std::span<const double> times, double resolution) {
  const double steps = static_cast<double>(times.size() - 1), span = times.back() - times.front(),
               uncertain = whole_resolution(times, resolution);
  const double high = span > uncertain ? steps / (span - uncertain) : std::numeric_limits<double>::infinity();
  return roundest(steps / (span + uncertain), steps / span, high);
}

bool steps_vary(const SampleTiming& timing) {
  const double mean = 1.0 / timing.mean_rate;
  return differ(1.0 / timing.median_rate, mean, timing.resolution) || differ(timing.largest_gap, mean, timing.resolution);
}

bool evenly_spaced(std::span<const double> times, double resolution) {
  if (times.size() < 2) return true;
  const double mean = mean_step(times), uncertain = whole_resolution(times, resolution);
  if (differ(median_step(times), mean, uncertain)) return false;
  // Largest excess and largest deficit of the intervals that end here.
  double longest = 0.0, shortest = 0.0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double excess = times[k] - times[k - 1] - mean, tolerated = rate_tolerance * mean;
    longest = std::max(longest, 0.0) + excess - tolerated;
    shortest = std::max(shortest, 0.0) - excess - tolerated;
    if (std::max(longest, shortest) > 0.5 * mean + uncertain) return false;
  }
  return true;
}

std::string timing_text(const SampleTiming& timing, double first) {
  return fmt::format(
      "{:.6g} Hz on average, {:.6g} Hz by the median step, the longest step is {:.4g} s, {:.6g} s after the first sample",
      timing.mean_rate, timing.median_rate, timing.largest_gap, timing.largest_gap_at - first);
}

}  // namespace slipbench
