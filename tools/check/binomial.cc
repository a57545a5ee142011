#include "tools/check/binomial.h"

#include <cmath>

namespace slipbench {
namespace {

// P(X >= k) for X binomial of n trials at rate p, k above the mean n p: the terms fall from the first on.
double upper_tail(std::size_t k, std::size_t n, double p) {
  const auto trials = static_cast<double>(n);
  auto count = static_cast<double>(k);
  const double log_ways = std::lgamma(trials + 1.0) - std::lgamma(count + 1.0) - std::lgamma(trials - count + 1.0);
  double term = std::exp(log_ways + count * std::log(p) + (trials - count) * std::log1p(-p));
  double sum = 0.0;
  constexpr double negligible = 1e-17;
  for (; count <= trials && term > negligible * sum; ++count) {
    sum += term;
    term *= (trials - count) / (count + 1.0) * p / (1.0 - p);
  }
  return sum;
}

// The rate at which P(X >= k) is `tail`, below 1/2. P grows with the rate, and is at least 1/2 from k = n p on: no more than the median.
double lower_end(std::size_t k, std::size_t n, double tail) {
  double low = 0.0;
  double high = static_cast<double>(k) / static_cast<double>(n);
  constexpr int halvings = 60;  // the width then is that of a double at 1
  for (int i = 0; i < halvings && k > 0; ++i) {
    const double middle = 0.5 * (low + high);
    (upper_tail(k, n, middle) < tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

RateInterval exact_interval(std::size_t successes, std::size_t trials, double confidence) {
  const double tail = 0.5 * (1.0 - confidence);
  return {lower_end(successes, trials, tail), 1.0 - lower_end(trials - successes, trials, tail)};
}

std::size_t least_successes(std::size_t trials, double rate, double confidence) {
  std::size_t from = 0;
  std::size_t to = trials + 1;
  while (from < to) {
    const std::size_t middle = from + (to - from) / 2;
    if (exact_interval(middle, trials, confidence).low < rate) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  return from;
}

}  // namespace slipbench
