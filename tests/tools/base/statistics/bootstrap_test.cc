#include "tools/base/statistics/descriptive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

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
