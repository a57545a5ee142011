#include "tools/run/binomial.h"

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
