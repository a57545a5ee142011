#include "tools/base/statistics/binomial.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace slipbench {
namespace {

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
