#include "tools/statistics/confusion.h"

#include <cmath>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

// 10 samples without contact; in contact 8 non-slip, 5 incipient, 7 gross.
constexpr Confusion mixed{{{7, 1, 1, 1}, {0, 6, 2, 0}, {1, 2, 1, 1}, {0, 1, 2, 4}}};

TEST(Confusion, SharesAreOfTheSamplesInContact) {
  EXPECT_EQ(samples_in_contact(mixed), 20U);
  EXPECT_EQ(samples_in(mixed, PadState::incipient), 5U);
  EXPECT_DOUBLE_EQ(accuracy(mixed), (6.0 + 1.0 + 4.0) / 20.0);
  EXPECT_DOUBLE_EQ(constant_accuracy(mixed), 8.0 / 20.0);
  EXPECT_DOUBLE_EQ(recall(mixed, PadState::incipient), 1.0 / 5.0);
  EXPECT_DOUBLE_EQ(balanced_accuracy(mixed), (6.0 / 8.0 + 1.0 / 5.0 + 4.0 / 7.0) / 3.0);
  EXPECT_DOUBLE_EQ(constant_balanced_accuracy(mixed), 1.0 / 3.0);
}

// Incipient slip detected as gross counts as detected: 1 + 1 of 5, and 2 + 4 of 7.
TEST(Confusion, RecallOfSlipIsOfBothKindsTogether) { EXPECT_DOUBLE_EQ(recall_of_slip(mixed), 8.0 / 12.0); }

// `counts` samples of each true state, all with the same answer.
Confusion always(PadState answer, const StateCounts& counts) {
  Confusion confusion{};
  for (std::size_t truth = 0; truth < 4; ++truth) confusion[truth][static_cast<std::size_t>(answer)] = counts[truth];
  return confusion;
}

// If k states occur, the answer's own has recall 1 and the others 0, for any sample counts.
TEST(Confusion, AConstantAnswerHasABalancedAccuracyOfOneInK) {
  for (const PadState answer : {PadState::non_slip, PadState::incipient, PadState::gross}) {
    EXPECT_DOUBLE_EQ(balanced_accuracy(always(answer, {3, 970, 2, 28})), 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(constant_balanced_accuracy(always(answer, {3, 970, 2, 28})), 1.0 / 3.0);
  }
  EXPECT_DOUBLE_EQ(balanced_accuracy(always(PadState::non_slip, {3, 970, 0, 30})), 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(balanced_accuracy(always(PadState::gross, {3, 970, 0, 30})), 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(balanced_accuracy(always(PadState::non_slip, {3, 970, 0, 0})), 1.0);
  // "no contact" is not a state in contact.
  EXPECT_EQ(balanced_accuracy(always(PadState::no_contact, {3, 970, 2, 28})), 0.0);
}

// A misleading number: no slip is detected, and accuracy is 97 %.
TEST(Confusion, AccuracyOfAConstantAnswerIsTheShareOfTheCommonestState) {
  const Confusion blind = always(PadState::non_slip, {50, 970, 10, 20});
  EXPECT_DOUBLE_EQ(accuracy(blind), 0.97);
  EXPECT_DOUBLE_EQ(constant_accuracy(blind), 0.97);
  EXPECT_EQ(recall_of_slip(blind), 0.0);
}

TEST(Confusion, SharesOfNothingAreNaN) {
  constexpr Confusion untouched{{{7, 1, 0, 0}, {}, {}, {}}};
  for (const auto share : {accuracy, constant_accuracy, balanced_accuracy, constant_balanced_accuracy, recall_of_slip}) {
    EXPECT_TRUE(std::isnan(share(untouched)));
  }
  constexpr Confusion never_slips{{{0, 0, 0, 0}, {0, 5, 0, 0}, {}, {}}};
  EXPECT_TRUE(std::isnan(recall_of_slip(never_slips)));
  EXPECT_TRUE(std::isnan(recall(never_slips, PadState::gross)));
}

TEST(Confusion, AddsUp) {
  Confusion sum{};
  count(sum, PadState::gross, PadState::non_slip);
  EXPECT_EQ(sum[3][1], 1U);
  EXPECT_EQ(samples_in_contact(sum), 1U);
  sum = mixed;
  add(sum, mixed);
  EXPECT_EQ(sum[1][2], 4U);
  EXPECT_EQ(samples_in_contact(sum), 40U);
}

// In `mixed` 12 samples slip, and 8 of them are detected (6 of gross, 2 of incipient). 18 do not
// slip: 10 without contact, 2 of which are called slip, and 8 non-slip, 2 of which are called slip:
// 14 of 18 are right, and 12 are called slip in total.
TEST(Confusion, SlipOrNotIsAskedOfEverySample) {
  EXPECT_DOUBLE_EQ(balanced_slip_accuracy(mixed), 0.5 * (8.0 / 12.0 + 14.0 / 18.0));
  EXPECT_DOUBLE_EQ(f1_of_slip(mixed), 2.0 * 8.0 / (12.0 + 12.0));
}

TEST(Confusion, SlipOrNotOfAConstantAnswer) {
  for (const PadState answer : {PadState::no_contact, PadState::non_slip, PadState::incipient, PadState::gross}) {
    EXPECT_DOUBLE_EQ(balanced_slip_accuracy(always(answer, {30, 970, 2, 28})), 0.5);
  }
  EXPECT_EQ(f1_of_slip(always(PadState::non_slip, {30, 970, 2, 28})), 0.0);
  EXPECT_TRUE(std::isnan(balanced_slip_accuracy(always(PadState::non_slip, {30, 970, 0, 0}))));
  EXPECT_TRUE(std::isnan(f1_of_slip(always(PadState::non_slip, {30, 970, 0, 0}))));
}

}  // namespace
}  // namespace slipbench
