#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tools/statistics/descriptive.h"

namespace slipbench {
namespace {

TEST(EvenlySpaced, KeepsTheFirstAndTheLast) {
  using Indices = std::vector<std::size_t>;
  EXPECT_EQ(evenly_spaced(11, 3), (Indices{0, 5, 10}));
  EXPECT_EQ(evenly_spaced(10, 4), (Indices{0, 3, 6, 9}));
  EXPECT_EQ(evenly_spaced(3, 5), (Indices{0, 1, 2}));
  EXPECT_EQ(evenly_spaced(8, 1), Indices{0});
  EXPECT_EQ(evenly_spaced(8, 0), Indices{});
  EXPECT_EQ(evenly_spaced(0, 4), Indices{});
}

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

// For evenly spaced values 0 to n - 1 the p-quantile is p (n - 1).
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

// All or none of n: the single bound solves p^n = 0.025.
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

// At the bounds the tails, summed from the other side, have the probability of the definition.
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
  // All of n prove tail^(1/n): 0.85 by 0.025^(1/n) >= 0.85, n >= ln 0.025/ln 0.85 = 22.7
  EXPECT_EQ(least_successes(22, 0.85, 0.95), 23U);  // no number of 22 suffices
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

// Half of 400 groups are 1, the others 0: a draw's mean has the standard deviation 1/2/sqrt(400) =
// 0.025, so 95 % of the draws lie within 0.5 +- 1.96 x 0.025 = 0.451 to 0.549. Of 2000 draws some
// 50 lie beyond each end, whose standard error is about 0.0015 (sqrt(0.025 x 0.975/2000)/density,
// with a density of 2.34 there), in steps of 1/400: 0.005 are allowed.
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

// The first figure is undefined in a draw without group 0, the second never.
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

const std::vector<double> positives{0.9, 0.6, 0.6, 0.2}, negatives{0.6, 0.1};

// From the top: 0.9 is one of four positives; 0.6 is two more and one of two negatives; 0.2 is the
// last positive; 0.1 the last negative.
TEST(RocCurve, APointAtEachValue) {
  const std::vector<RocPoint> points = roc_curve(positives, negatives, 100);
  ASSERT_EQ(points.size(), 5U);
  EXPECT_EQ(points[0].threshold, std::numeric_limits<double>::infinity());
  const double thresholds[] = {0.9, 0.6, 0.2, 0.1}, wrong[] = {0.0, 0.5, 0.5, 1.0}, right[] = {0.25, 0.75, 1.0, 1.0};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(points[k + 1].threshold, thresholds[k]);
    EXPECT_EQ(points[k + 1].false_share, wrong[k]);
    EXPECT_EQ(points[k + 1].true_share, right[k]);
  }
}

TEST(RocCurve, KeepsItsEndsWhereItIsThinned) {
  const std::vector<RocPoint> points = roc_curve(positives, negatives, 3);
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points.front().true_share, 0.0);
  EXPECT_EQ(points[1].threshold, 0.6);
  EXPECT_EQ(points.back().false_share, 1.0);
}

TEST(RocCurve, NeedsBothClasses) {
  EXPECT_THROW(roc_curve({}, negatives, 9), std::invalid_argument);
  EXPECT_THROW(roc_curve(positives, {}, 9), std::invalid_argument);
  EXPECT_THROW(roc_curve(positives, negatives, 1), std::invalid_argument);
  EXPECT_THROW(roc_curve(positives, std::vector<double>{std::nan("")}, 9), std::invalid_argument);
}

// Two bins: below 0.5 are 0.2 (positive) and 0.1; from 0.5 on 0.9, 0.6, 0.6 (positive) and 0.6.
TEST(Calibration, ComparesWhatWasSaidWithWhatWasTrue) {
  const std::vector<CalibrationBin> bins = calibration(positives, negatives, 2);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_EQ(bins[0].count, 2U);
  EXPECT_DOUBLE_EQ(bins[0].mean, 0.15);
  EXPECT_DOUBLE_EQ(bins[0].share, 0.5);
  EXPECT_DOUBLE_EQ(bins[1].mean, (0.9 + 3.0 * 0.6) / 4.0);
  EXPECT_DOUBLE_EQ(bins[1].share, 0.75);
}

TEST(Calibration, BothEndsBelongToIt) {
  const std::vector<CalibrationBin> bins = calibration(std::vector<double>{1.0}, std::vector<double>{0.0}, 10);
  ASSERT_EQ(bins.size(), 2U);  // the eight between them are empty
  EXPECT_EQ(bins[0].low, 0.0);
  EXPECT_EQ(bins[1].high, 1.0);
  EXPECT_EQ(bins[1].share, 1.0);
  EXPECT_THROW(calibration(std::vector<double>{1.1}, {}, 10), std::invalid_argument);
  EXPECT_THROW(calibration(positives, negatives, 0), std::invalid_argument);
}

using Values = std::vector<double>;
using Groups = std::vector<std::size_t>;

// 3 x 2 pairs: (3,1) (3,2) (2,1) are in order, (2,2) and (1,1) are ties and (1,2) is reversed, so
// 3 + 2/2 = 4 of 6.
TEST(Auc, CountsPairsAndHalvesTies) {
  const Auc found = auc(Values{1.0, 2.0, 3.0}, Values{2.0, 1.0});
  EXPECT_DOUBLE_EQ(found.value, 4.0 / 6.0);
  EXPECT_EQ(found.positives, 3u);
  EXPECT_EQ(found.negatives, 2u);
  EXPECT_DOUBLE_EQ(auc(Values{2.0, 1.0}, Values{1.0, 2.0, 3.0}).value, 2.0 / 6.0);
}

// Shares of negatives below the positives 1, 2, 3: 1/4, 3/4, 1: mean 2/3, variance of the mean (25
// + 1 + 16)/144/2/3 = 7/144. Shares of positives below the negatives 2, 1: 1/2, 1/6, which DeLong
// takes as 1 - 1/2, 1 - 1/6 with the same variance (1/18)/2 = 1/36.
TEST(Auc, HasDeLongsInterval) {
  const Auc found = auc(Values{1.0, 2.0, 3.0}, Values{2.0, 1.0});
  const double reach = 1.959963984540054 * std::sqrt(7.0 / 144.0 + 1.0 / 36.0);
  EXPECT_NEAR(found.interval.low, 4.0 / 6.0 - reach, 1e-12);
  EXPECT_EQ(found.interval.high, 1.0);  // 1.21 would exceed the range
}

// Four pairs, all in order: the rate at which four of four have the probability 0.025 is its fourth
// root.
TEST(Auc, OfWhatIsApartEndsAtOne) {
  const Auc found = auc(Values{5.0, 6.0, 7.0, 8.0}, Values{1.0, 2.0, 3.0, 4.0, 4.5});
  EXPECT_EQ(found.value, 1.0);
  EXPECT_EQ(found.interval.high, 1.0);
  EXPECT_NEAR(found.interval.low, std::pow(0.025, 0.25), 1e-9);
  EXPECT_EQ(auc(Values{1.0}, Values{2.0}).value, 0.0);
}

// Repeated frames add no information: five copies of each value of the example above give the same
// interval.
TEST(Auc, CountsGroupsAndNotTheirCopies) {
  Values positives, negatives;
  Groups positive_group, negative_group;
  for (const double value : {1.0, 2.0, 3.0}) {
    positives.insert(positives.end(), 5, value);
    positive_group.insert(positive_group.end(), 5, static_cast<std::size_t>(value));
  }
  for (const double value : {2.0, 1.0}) {
    negatives.insert(negatives.end(), 5, value);
    negative_group.insert(negative_group.end(), 5, 10 + static_cast<std::size_t>(value));
  }
  const Auc found = auc(positives, positive_group, negatives, negative_group);
  const Auc alone = auc(Values{1.0, 2.0, 3.0}, Values{2.0, 1.0});
  EXPECT_DOUBLE_EQ(found.value, 4.0 / 6.0);
  EXPECT_NEAR(found.interval.low, alone.interval.low, 1e-12);
  EXPECT_EQ(found.positives, 15u);
  EXPECT_GT(auc(positives, negatives).interval.low, alone.interval.low) << "as if all were apart";
}

// Two recordings, each with a positive and a negative: (4, 3) and (2, 1). Three of four pairs are
// in order. The shares of negatives below the positives are 1 and 1/2, those of positives above the
// negatives 1/2 and 1; minus 3/4 these are +1/4, -1/4 and -1/4, +1/4. Obuchowski: (2/1 (2/16)/4)
// twice, and 2 * 2/1 * (-2/16)/4: 1/16 + 1/16 - 1/8 = 0. In each recording the gain of its positive
// equals the loss of its negative.
TEST(Auc, TakesBothClassesOfAGroupTogether) {
  const Auc found = auc(Values{4.0, 2.0}, Groups{0, 1}, Values{3.0, 1.0}, Groups{0, 1});
  EXPECT_DOUBLE_EQ(found.value, 0.75);
  EXPECT_NEAR(found.interval.low, 0.75, 1e-9);
  EXPECT_NEAR(found.interval.high, 0.75, 1e-9);
  // Ungrouped, DeLong: 1/16 + 1/16.
  EXPECT_NEAR(auc(Values{4.0, 2.0}, Values{3.0, 1.0}).interval.low, 0.75 - 1.959963984540054 * std::sqrt(0.125), 1e-12);
  // All in order: two groups, and the rate at which two of two have the probability 0.025 is its
  // square root.
  EXPECT_NEAR(auc(Values{4.0, 5.0, 6.0}, Groups{0, 0, 1}, Values{3.0, 1.0}, Groups{0, 1}).interval.low, std::sqrt(0.025), 1e-9);
}

TEST(Auc, RefusesWhatCannotBeOrdered) {
  EXPECT_THROW((void)auc(Values{}, Values{1.0}), std::invalid_argument);
  EXPECT_THROW((void)auc(Values{1.0}, Values{}), std::invalid_argument);
  EXPECT_THROW((void)auc(Values{1.0}, Groups{0, 1}, Values{2.0}, Groups{0}), std::invalid_argument);
  EXPECT_THROW((void)auc(Values{1.0, std::numeric_limits<double>::quiet_NaN()}, Values{1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace slipbench
