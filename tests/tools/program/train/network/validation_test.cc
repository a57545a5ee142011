#include "tools/program/train/network/validation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace slipbench::train::validation_test {
namespace {

// 8 of 10 slip and 60 of 90 hold frames right: (0.8 + 2/3)/2; precision 8/38, recall 8/10, F1 = 16/(16 + 2 + 30).
TEST(Counts, GiveBalancedAccuracyAndF1) {
  const Counts counts{8, 2, 30, 60};
  EXPECT_DOUBLE_EQ(counts.balanced_accuracy(), 0.5 * (0.8 + 60.0 / 90.0));
  EXPECT_DOUBLE_EQ(counts.f1(), 2.0 * (8.0 / 38.0) * 0.8 / (8.0 / 38.0 + 0.8));
  EXPECT_TRUE(std::isnan(Counts({0, 0, 1, 1}).balanced_accuracy()));
  Counts sum;
  sum.add(true, true);
  sum.add(true, false);
  sum.add(false, true);
  sum.add(false, false);
  sum.add(counts);
  EXPECT_EQ(sum.slip_called_slip, 9U);
  EXPECT_EQ(sum.slip_called_hold, 3U);
  EXPECT_EQ(sum.hold_called_slip, 31U);
  EXPECT_EQ(sum.hold_called_hold, 61U);
}

// Of the first example one frame has no label and one is not judged; the last is in another fold.
TEST(Counts, AreOfJudgedFramesByGroup) {
  const std::vector<FoldExample> examples{{{{}, {1, 0, masked, 0, 1}}, 1}, {{{}, {0, 1}}, 0}, {{{}, {1, 1}}, 2}};
  const std::vector<Counts> counts = counts_of(examples, {{masked, 1, 1, 0, 1}, {0, 0}, {}});
  ASSERT_EQ(counts.size(), 3U);
  EXPECT_EQ(counts[1].slip_called_slip, 1U);  // the fifth
  EXPECT_EQ(counts[1].hold_called_slip, 1U);  // the second
  EXPECT_EQ(counts[1].hold_called_hold, 1U);
  EXPECT_EQ(counts[1].slip_called_hold, 0U);  // the first is not judged
  EXPECT_EQ(counts[0].hold_called_hold, 1U);
  EXPECT_EQ(counts[0].slip_called_hold, 1U);
  EXPECT_TRUE(std::isnan(counts[2].f1()));
}

// 11 of one group and 7 of the other in five folds: 2 or 3 and 1 or 2 in each.
TEST(Folds, HoldAsManyOfEachGroup) {
  std::vector<std::size_t> groups(18, 0);
  for (std::size_t i = 0; i < 7; ++i) groups[2 * i] = 1;
  const std::vector<std::size_t> fold_of = folds(groups, 5, 3);
  std::array<std::array<std::size_t, 5>, 2> sizes{};
  for (std::size_t i = 0; i < groups.size(); ++i) ++sizes[groups[i]].at(fold_of[i]);
  for (std::size_t fold = 0; fold < 5; ++fold) {
    EXPECT_EQ(sizes[0][fold], fold < 1 ? 3U : 2U);
    EXPECT_EQ(sizes[1][fold], fold < 2 ? 2U : 1U);
  }
  EXPECT_EQ(folds(groups, 5, 3), fold_of);
  EXPECT_NE(folds(groups, 5, 4), fold_of);
  EXPECT_THROW(folds(groups, 1, 3), std::invalid_argument);
}

// A straight line tells 0, 1 and 2 apart; whoever is outside of the fold says nothing.
TEST(Logits, AreOfTheFoldAloneAndOfAllClasses) {
  if (!networks_available()) GTEST_SKIP() << "no libtorch";
  std::vector<FoldExample> examples;
  std::vector<std::size_t> fold_of;
  for (std::size_t i = 0; i < 12; ++i) {
    examples.push_back({{{static_cast<float>(i % 3)}, {static_cast<std::uint8_t>(i % 3)}}});
    fold_of.push_back(i < 9 ? 0 : 1);
  }
  Validation validation{{1, {Linear{3}}}, {.steps = 400, .optimiser = Optimiser::adam, .learning_rate = 0.1}};
  validation.scaling = Scaling::range;
  const Logits logits = logits_in_fold(examples, fold_of, 1, validation);
  ASSERT_EQ(logits.size(), 12U);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_TRUE(logits[i].empty());
  for (std::size_t i = 9; i < 12; ++i) {
    ASSERT_EQ(logits[i].size(), 3U);
    EXPECT_EQ(std::ranges::max_element(logits[i]) - logits[i].begin(), static_cast<std::ptrdiff_t>(i % 3));
  }
}

}  // namespace
}  // namespace slipbench::train::validation_test
