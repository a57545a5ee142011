#include "tools/base/statistics/roc.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace slipbench
