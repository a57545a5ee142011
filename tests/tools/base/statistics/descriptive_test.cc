#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tools/base/statistics/descriptive.h"

namespace slipbench {
namespace {

TEST(MeanSd, OfTheSample) {
  const MeanSd found = mean_sd(std::vector<double>{1.0, 2.0, 3.0, 4.0});
  EXPECT_DOUBLE_EQ(found.mean, 2.5);
  EXPECT_DOUBLE_EQ(found.sd, std::sqrt(5.0 / 3.0));  // 2.25 + 0.25 + 0.25 + 2.25 over 3
  EXPECT_TRUE(std::isnan(mean_sd(std::vector<double>{1.0}).sd));
  EXPECT_TRUE(std::isnan(mean_sd({}).mean));
}

TEST(Quantile, IsInterpolated) {
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 0.25), 1.75);  // a quarter of the way of three steps
  EXPECT_DOUBLE_EQ(quantile({7.0}, 0.75), 7.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0}, 1.0), 2.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

// Of values at equal distances, 0 to n - 1, the p-quantile is p (n - 1).
TEST(Quantile, OfALadderIsItsShare) {
  std::vector<double> ladder;
  for (int n = 1; n <= 40; ++n) {
    ladder.insert(ladder.begin(), n - 1.0);
    for (const double p : {0.0, 0.01, 0.25, 0.5, 0.99, 1.0})
      EXPECT_NEAR(quantile(ladder, p), p * (n - 1), 1e-12) << n << " " << p;
  }
}

TEST(Median, IsTheMiddleOrTheMeanOfTwo) {
  EXPECT_EQ(median({5.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({5.0, 1.0, 2.0, 4.0}), 3.0);
  EXPECT_TRUE(std::isnan(median({})));
}

// How many of n values lie below the median is binomial with 1/2. Outside of the outermost two of five it lies with 2/32, of six with 2/64; outside of
// the second and the eighth of nine with 20/512, of the third and the seventh with 92/512.
TEST(MedianInterval, IsWithinOrderStatistics) {
  EXPECT_TRUE(std::isnan(median_interval({1, 2, 3, 4, 5}).low));
  const Interval six = median_interval({6, 5, 4, 3, 2, 1});
  EXPECT_DOUBLE_EQ(six.low, 1.0);
  EXPECT_DOUBLE_EQ(six.high, 6.0);
  const Interval nine = median_interval({1, 2, 3, 4, 5, 6, 7, 8, 9});
  EXPECT_DOUBLE_EQ(nine.low, 2.0);
  EXPECT_DOUBLE_EQ(nine.high, 8.0);
}

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

using Drawn = std::span<const std::size_t>;

// Half of 400 groups are 1, the others 0: a draw's mean has the standard deviation 1/2/sqrt(400) = 0.025, so that 95 % of the draws lie within
// 0.5 +- 1.96 x 0.025 = 0.451 to 0.549. Of 2000 draws some 50 lie beyond each end, and that end scatters by about 0.0015
// (sqrt(0.025 x 0.975/2000)/density, the density there being 2.34), beside steps of 1/400: 0.005 are allowed.
TEST(Bootstrap, IntervalOfAShare) {
  const auto mean = [](Drawn drawn) {
    double sum = 0.0;
    for (const std::size_t group : drawn) sum += group < 200 ? 1.0 : 0.0;
    return std::vector<double>{sum / static_cast<double>(drawn.size())};
  };
  const std::vector<Interval> intervals = bootstrap_intervals(400, 2000, 1, mean);
  ASSERT_EQ(intervals.size(), 1U);
  EXPECT_NEAR(intervals[0].low, 0.451, 0.005);
  EXPECT_NEAR(intervals[0].high, 0.549, 0.005);
}

TEST(Bootstrap, SameSeedSameIntervals) {
  const auto first = [](Drawn drawn) { return std::vector<double>{static_cast<double>(drawn[0])}; };
  const Interval one = bootstrap_intervals(1000, 20, 1, first)[0];
  EXPECT_EQ(one.low, bootstrap_intervals(1000, 20, 1, first)[0].low);
  EXPECT_NE(one.low, bootstrap_intervals(1000, 20, 2, first)[0].low);
}

// The first figure has no value in a draw without group 0, the second in none.
TEST(Bootstrap, LeavesOutWhatHasNoValue) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto figures = [](Drawn drawn) { return std::vector<double>{std::ranges::count(drawn, 0U) > 0 ? 7.0 : nan, nan}; };
  const std::vector<Interval> intervals = bootstrap_intervals(2, 100, 1, figures);
  EXPECT_EQ(intervals[0].low, 7.0);
  EXPECT_EQ(intervals[0].high, 7.0);
  EXPECT_TRUE(std::isnan(intervals[1].low));
  EXPECT_TRUE(std::isnan(intervals[1].high));
}

TEST(Bootstrap, OneGroupTellsNothing) {
  const auto one = [](Drawn) { return std::vector<double>{1.0}; };
  EXPECT_TRUE(std::isnan(bootstrap_intervals(1, 10, 1, one)[0].low));
  EXPECT_THROW(bootstrap_intervals(1, 0, 1, one), std::logic_error);
}

}  // namespace

}  // namespace slipbench
