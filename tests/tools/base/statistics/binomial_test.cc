#include "tools/base/statistics/binomial.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// All or none of n: the one bound solves p^n = 0.025.
TEST(ClopperPearson, AllOrNone) {
  const Interval all = clopper_pearson(10, 10);
  EXPECT_NEAR(all.low, std::pow(0.025, 0.1), 1e-14);
  EXPECT_EQ(all.high, 1.0);
  const Interval none = clopper_pearson(0, 10);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_NEAR(none.high, 1.0 - std::pow(0.025, 0.1), 1e-14);
}

// One of two: 1 - (1 - low)^2 = 0.05 and high^2 = 1 - 0.05, at a confidence of 90 %.
TEST(ClopperPearson, OneOfTwo) {
  const Interval share = clopper_pearson(1, 2, 0.9);
  EXPECT_NEAR(share.low, 1.0 - std::sqrt(0.95), 1e-14);
  EXPECT_NEAR(share.high, std::sqrt(0.95), 1e-14);
}

// At the bounds the tails, summed from the other side, have the probability that the definition says.
TEST(ClopperPearson, TailsAreAsDefined) {
  const int k = 37;
  const int n = 100;
  const Interval share = clopper_pearson(k, n);
  const auto term = [&](double p, int i) {
    return std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) + i * std::log(p) +
                    (n - i) * std::log(1.0 - p));
  };
  double below = 0.0;
  for (int i = 0; i < k; ++i) below += term(share.low, i);
  EXPECT_NEAR(1.0 - below, 0.025, 1e-12);
  double above = 0.0;
  for (int i = k + 1; i <= n; ++i) above += term(share.high, i);
  EXPECT_NEAR(1.0 - above, 0.025, 1e-12);
}

TEST(ClopperPearson, OfTwoOfThree) {
  // P(X >= 2) = 3 p^2 - 2 p^3 at the lower end, P(X <= 2) = 1 - p^3 at the upper one
  const Interval interval = clopper_pearson(2, 3, 0.9);
  EXPECT_NEAR(3.0 * std::pow(interval.low, 2) - 2.0 * std::pow(interval.low, 3), 0.05, 1e-14);
  EXPECT_NEAR(interval.high, std::cbrt(0.95), 1e-14);
}

TEST(ClopperPearson, OfAMillionNearsTheNormalOne) {
  // p +- z sqrt(p (1-p)/n), z of 97.5 % 1.959964; skewness and continuity are of the order of 1/n.
  const double half = 1.959964 * std::sqrt(0.9 * 0.1 / 1e6);
  const Interval interval = clopper_pearson(900'000, 1'000'000, 0.95);
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
    EXPECT_GE(clopper_pearson(least, n, 0.95).low, 0.5);
    EXPECT_LT(clopper_pearson(least - 1, n, 0.95).low, 0.5);
  }
}

TEST(ClopperPearson, WithoutTrialsEverythingIsPossible) {
  EXPECT_EQ(clopper_pearson(0, 0).low, 0.0);
  EXPECT_EQ(clopper_pearson(0, 0).high, 1.0);
}

TEST(ClopperPearson, RefusesWhatIsNoShare) {
  EXPECT_THROW(clopper_pearson(3, 2), std::logic_error);
  EXPECT_THROW(clopper_pearson(1, 2, 1.0), std::logic_error);
}

}  // namespace
}  // namespace slipbench
