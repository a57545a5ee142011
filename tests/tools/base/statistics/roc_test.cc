#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tools/base/statistics/descriptive.h"

namespace slipbench {
namespace {

const std::vector<double> positives{0.9, 0.6, 0.6, 0.2}, negatives{0.6, 0.1};

// From the top: 0.9 is one of four positives; 0.6 two more and one of two negatives; 0.2 the last positive; 0.1 the last negative.
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

// Two parts: below 0.5 lie 0.2 (positive) and 0.1, from it on 0.9, 0.6, 0.6 (positive) and 0.6.
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
  ASSERT_EQ(bins.size(), 2U);  // the eight between them hold nothing
  EXPECT_EQ(bins[0].low, 0.0);
  EXPECT_EQ(bins[1].high, 1.0);
  EXPECT_EQ(bins[1].share, 1.0);
  EXPECT_THROW(calibration(std::vector<double>{1.1}, {}, 10), std::invalid_argument);
  EXPECT_THROW(calibration(positives, negatives, 0), std::invalid_argument);
}

using Values = std::vector<double>;
using Groups = std::vector<std::size_t>;

// Of 3 x 2 pairs (3,1) (3,2) (2,1) are in order and (2,2) is a tie; (1,1) is a tie and (1,2) is not: 3 + 2/2 = 4 of 6.
TEST(Auc, CountsPairsAndHalvesTies) {
  const Auc found = auc(Values{1.0, 2.0, 3.0}, Values{2.0, 1.0});
  EXPECT_DOUBLE_EQ(found.value, 4.0 / 6.0);
  EXPECT_EQ(found.positives, 3u);
  EXPECT_EQ(found.negatives, 2u);
  EXPECT_DOUBLE_EQ(auc(Values{2.0, 1.0}, Values{1.0, 2.0, 3.0}).value, 2.0 / 6.0);
}

// Shares of negatives below the positives 1, 2, 3: 1/4, 3/4, 1: mean 2/3, variance of the mean (25 + 1 + 16)/144/2/3 = 7/144. Of positives
// below the negatives 2, 1: 1/2, 1/6, which DeLong takes as 1 - 1/2, 1 - 1/6 with the same variance (1/18)/2 = 1/36.
TEST(Auc, HasDeLongsInterval) {
  const Auc found = auc(Values{1.0, 2.0, 3.0}, Values{2.0, 1.0});
  const double reach = 1.959963984540054 * std::sqrt(7.0 / 144.0 + 1.0 / 36.0);
  EXPECT_NEAR(found.interval.low, 4.0 / 6.0 - reach, 1e-12);
  EXPECT_EQ(found.interval.high, 1.0);  // 1.21 would be more than there is
}

// Four pairs, none the wrong way round: the rate at which four of four have the probability 0.025 is its fourth root.
TEST(Auc, OfWhatIsApartEndsAtOne) {
  const Auc found = auc(Values{5.0, 6.0, 7.0, 8.0}, Values{1.0, 2.0, 3.0, 4.0, 4.5});
  EXPECT_EQ(found.value, 1.0);
  EXPECT_EQ(found.interval.high, 1.0);
  EXPECT_NEAR(found.interval.low, std::pow(0.025, 0.25), 1e-9);
  EXPECT_EQ(auc(Values{1.0}, Values{2.0}).value, 0.0);
}

// Frames that repeat each other say no more than one of them: five copies of each value of the example above have its interval.
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

// Two recordings, each with a positive and a negative: (4, 3) and (2, 1). Three of four pairs are in order. Above the negatives are 1 and 1/2 of
// them, of the positives above the negatives 1/2 and 1: less 3/4 that is +1/4, -1/4 and -1/4, +1/4. Obuchowski: (2/1 (2/16)/4)
// twice, and 2 * 2/1 * (-2/16)/4: 1/16 + 1/16 - 1/8 = 0. What one recording has more of its positive it lacks of its negative.
TEST(Auc, TakesBothClassesOfAGroupTogether) {
  const Auc found = auc(Values{4.0, 2.0}, Groups{0, 1}, Values{3.0, 1.0}, Groups{0, 1});
  EXPECT_DOUBLE_EQ(found.value, 0.75);
  EXPECT_NEAR(found.interval.low, 0.75, 1e-9);
  EXPECT_NEAR(found.interval.high, 0.75, 1e-9);
  // Apart, DeLong: 1/16 + 1/16.
  EXPECT_NEAR(auc(Values{4.0, 2.0}, Values{3.0, 1.0}).interval.low, 0.75 - 1.959963984540054 * std::sqrt(0.125), 1e-12);
  // All in order: two groups, and the rate at which two of two have the probability 0.025 is its root.
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
