// The division of a page among its trials, from sizes alone.
#include "tools/report/page_budget.h"

#include <cstddef>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench::report {
namespace {

std::vector<std::size_t> numbers(std::size_t count) {
  std::vector<std::size_t> trials(count);
  std::iota(trials.begin(), trials.end(), std::size_t{0});
  return trials;
}

TEST(PageBudget, CurvesHaveEverySampleUpToALimitAndAtLeast24Rows) {
  EXPECT_EQ(curve_range(10, 1000).finest, 10'000U);
  EXPECT_EQ(curve_range(10, 1000).coarsest, 240U);
  EXPECT_EQ(curve_range(10, 7).coarsest, 70U);
  EXPECT_EQ(curve_range(10, 0).finest, 10U);
  EXPECT_EQ(curve_range(100, 1'000'000).finest, most_curve_values);
}

// 19 MB less 0.7 MB for the scripts and 0.3 MB for the rows leave 18 MB.
TEST(PageBudget, EveryTrialGetsTheSameShare) {
  PageBudget budget({100'000, 2400}, 1000, 18, 300'000);
  EXPECT_EQ(budget.count(), 18U);
  EXPECT_EQ(budget.curve_values(), 100'000U);
  EXPECT_TRUE(budget.accept(1'000'000));
  EXPECT_FALSE(budget.accept(2'000'000));
  EXPECT_EQ(budget.curve_values(), 45'000U);
  EXPECT_TRUE(budget.accept(900'000));
  EXPECT_EQ(budget.curve_values(), 45'000U);
}

TEST(PageBudget, CurvesGetNoCoarserThanTheRange) {
  PageBudget budget({100'000, 90'000}, 1000, 18, 300'000);
  EXPECT_FALSE(budget.accept(50'000'000));
  EXPECT_EQ(budget.curve_values(), 90'000U);
  EXPECT_TRUE(budget.accept(50'000'000));
}

TEST(PageBudget, FewerTrialsHaveCurvesIfTheCoarsestDoNotFit) {
  EXPECT_EQ(PageBudget({100'000, 2400}, 1'000'000, 1000, 300'000).count(), 16U);  // 18 MB in parts of 1.1 MB
  EXPECT_EQ(PageBudget({100'000, 2400}, 500'000'000, 1000, 300'000).count(), 1U);
  EXPECT_EQ(PageBudget({100'000, 2400}, 100'000, 1000, 30'000'000).count(), 18U);  // rows leave at least 2 MB
  EXPECT_EQ(PageBudget().count(), 1U);
}

TEST(PageBudget, TheRequestedTrialReplacesTheNearestOne) {
  const std::vector<std::size_t> trials = numbers(100);
  const std::vector<std::size_t> spaced = trials_with_curves(trials, 4, {});
  EXPECT_EQ(spaced.size(), 4U);
  const std::size_t asked = spaced[1] + 1;
  std::vector<std::size_t> expected = spaced;
  expected[1] = asked;
  EXPECT_EQ(trials_with_curves(trials, 4, asked), expected);
  EXPECT_EQ(trials_with_curves(trials, 4, spaced[2]), spaced);
}

TEST(PageBudget, TrialsWithCurvesAlsoHaveRows) {
  EXPECT_EQ(trials_with_rows(numbers(10), {3}, 2), (std::vector<std::size_t>{0, 3, 5}));
  EXPECT_EQ(trials_with_rows(numbers(3), {1}, 20), numbers(3));
}

}  // namespace
}  // namespace slipbench::report
