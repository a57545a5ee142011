// The exact interval against what can be solved by hand: P(X >= k) = sum of C(n,i) p^i (1-p)^(n-i) from i = k to n.
#include "tools/check/binomial.h"

#include <cmath>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

constexpr double rounding = 1e-14;

TEST(ExactInterval, OfNoneAndOfAll) {
  for (const std::size_t n : {1U, 2U, 20U, 1000U}) {
    for (const double confidence : {0.5, 0.9, 0.95, 0.999}) {
      const double tail = 0.5 * (1.0 - confidence);
      // P(X >= n) = p^n
      const double low = std::pow(tail, 1.0 / static_cast<double>(n));
      const RateInterval all = exact_interval(n, n, confidence);
      EXPECT_NEAR(all.low, low, rounding) << n;
      EXPECT_EQ(all.high, 1.0);
      const RateInterval none = exact_interval(0, n, confidence);
      EXPECT_EQ(none.low, 0.0);
      EXPECT_NEAR(none.high, 1.0 - low, rounding) << n;
    }
  }
}

TEST(ExactInterval, OfOneOfTwo) {
  // P(X >= 1) = 1 - (1-p)^2 = a: p = 1 - sqrt(1-a)
  const double low = 1.0 - std::sqrt(1.0 - 0.025);
  const RateInterval interval = exact_interval(1, 2, 0.95);
  EXPECT_NEAR(interval.low, low, rounding);
  EXPECT_NEAR(interval.high, 1.0 - low, rounding);
}

TEST(ExactInterval, OfTwoOfThree) {
  // P(X >= 2) = 3 p^2 - 2 p^3 at the lower end, P(X <= 2) = 1 - p^3 at the upper one
  const RateInterval interval = exact_interval(2, 3, 0.9);
  EXPECT_NEAR(3.0 * std::pow(interval.low, 2) - 2.0 * std::pow(interval.low, 3), 0.05, rounding);
  EXPECT_NEAR(interval.high, std::cbrt(0.95), rounding);
}

TEST(ExactInterval, OfAMillionNearsTheNormalOne) {
  // p +- z sqrt(p (1-p)/n), z of 97.5 % 1.959964; skewness and continuity are of the order of 1/n.
  const double half = 1.959964 * std::sqrt(0.9 * 0.1 / 1e6);
  const RateInterval interval = exact_interval(900'000, 1'000'000, 0.95);
  EXPECT_NEAR(interval.low, 0.9 - half, 3e-6);
  EXPECT_NEAR(interval.high, 0.9 + half, 3e-6);
}

TEST(LeastSuccesses, BeginNoLowerThanAsked) {
  // All of n show tail^(1/n): 0.85 by 0.025^(1/n) >= 0.85, n >= ln 0.025/ln 0.85 = 22.7
  EXPECT_EQ(least_successes(22, 0.85, 0.95), 23U);  // no number of 22 does
  EXPECT_EQ(least_successes(23, 0.85, 0.95), 23U);
  EXPECT_EQ(least_successes(5, 0.0, 0.95), 0U);
  for (const std::size_t n : {10U, 57U}) {
    const std::size_t least = least_successes(n, 0.5, 0.95);
    EXPECT_GE(exact_interval(least, n, 0.95).low, 0.5);
    EXPECT_LT(exact_interval(least - 1, n, 0.95).low, 0.5);
  }
}

}  // namespace
}  // namespace slipbench
