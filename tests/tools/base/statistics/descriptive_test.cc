#include "tools/base/statistics/descriptive.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace slipbench
