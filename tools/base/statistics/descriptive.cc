#include "tools/base/statistics/descriptive.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "sim/core/random.h"

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Probability of k or more successes in n trials with p in (0, k/n]: from k on the terms only fall.
double upper_tail(double k, double n, double p) {
  double term = std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(p) +
                         (n - k) * std::log1p(-p));
  double sum = 0.0;
  for (double i = k; i <= n && term > std::numeric_limits<double>::epsilon() * sum; ++i) {
    sum += term;
    term *= (n - i) / (i + 1.0) * p / (1.0 - p);
  }
  return sum;
}

double lower_bound(std::size_t k, std::size_t n, double outside) {
  if (k == 0) return 0.0;
  const auto [count, all] = std::pair{static_cast<double>(k), static_cast<double>(n)};
  if (k == n) return std::pow(outside, 1.0 / all);
  double low = 0.0;
  double high = count / all;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;  // they are neighbours
    (upper_tail(count, all, middle) < outside ? low : high) = middle;
  }
}

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

double median_time(std::size_t passes, const std::function<void()>& pass) {
  std::vector<double> times;
  for (std::size_t k = 0; k < passes; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    pass();
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return median(std::move(times));
}

Interval median_interval(std::vector<double> values) {
  std::ranges::sort(values);
  std::size_t r = 0;
  while (r < values.size() && clopper_pearson(r, values.size()).high <= 0.5) ++r;
  return r == 0 ? Interval{nan, nan} : Interval{values[r - 1], values[values.size() - r]};
}

std::vector<Interval> bootstrap_intervals(std::size_t groups, std::size_t draws, std::uint64_t seed,
                                          const std::function<std::vector<double>(std::span<const std::size_t>)>& figures) {
  if (draws == 0) throw std::logic_error("a bootstrap needs a draw");
  std::vector<std::size_t> drawn(groups);
  std::vector<std::vector<double>> values;  // [figure][draw]
  for (std::size_t draw = 0; draw < draws; ++draw) {
    RandomStream stream(seed, draw, "intervals");
    for (std::size_t& group : drawn) group = stream.integer(groups);
    const std::vector<double> found = figures(drawn);
    values.resize(found.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (!std::isnan(found[k])) values[k].push_back(found[k]);
    }
  }
  std::vector<Interval> intervals;
  for (const std::vector<double>& of_figure : values) {
    intervals.push_back(groups < 2 ? Interval{nan, nan} : Interval{quantile(of_figure, 0.025), quantile(of_figure, 0.975)});
  }
  return intervals;
}

Interval clopper_pearson(std::size_t k, std::size_t n, double confidence) {
  if (k > n || !(confidence > 0.0 && confidence < 1.0)) throw std::logic_error("no such binomial interval");
  if (n == 0) return {};
  const double outside = 0.5 * (1.0 - confidence);
  return {lower_bound(k, n, outside), 1.0 - lower_bound(n - k, n, outside)};
}

std::size_t least_successes(std::size_t n, double rate, double confidence) {
  std::size_t from = 0;
  std::size_t to = n + 1;
  while (from < to) {
    const std::size_t middle = from + (to - from) / 2;
    if (clopper_pearson(middle, n, confidence).low < rate) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  return from;
}

}  // namespace slipbench
