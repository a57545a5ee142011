#include "tools/program/train/confusion_matrix.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace slipbench::testing {
namespace {

using ::testing::DoubleEq;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr PadState non_slip = PadState::non_slip;
constexpr PadState incipient = PadState::incipient;
constexpr PadState gross = PadState::gross;
constexpr double never = std::numeric_limits<double>::quiet_NaN();

TEST(ConfusionMatrix, CountsShares) {
  ConfusionMatrix confusion;
  for (int i = 0; i < 6; ++i) confusion.add(non_slip, non_slip);
  for (int i = 0; i < 2; ++i) confusion.add(non_slip, gross);
  confusion.add(incipient, incipient);
  confusion.add(incipient, gross);
  EXPECT_EQ(confusion.total(), 10U);
  EXPECT_DOUBLE_EQ(confusion.accuracy(), 7.0 / 10.0);
  EXPECT_DOUBLE_EQ(confusion.recall(non_slip), 6.0 / 8.0);
  EXPECT_DOUBLE_EQ(confusion.recall(incipient), 1.0 / 2.0);
  EXPECT_TRUE(std::isnan(confusion.recall(gross)));
  // Of the two classes that occur.
  EXPECT_DOUBLE_EQ(confusion.balanced_accuracy(), (0.75 + 0.5) / 2.0);
  ConfusionMatrix twice = confusion;
  twice.add(confusion);
  EXPECT_EQ(twice.count(non_slip, gross), 4U);
}

TEST(ConfusionMatrix, OfNothingIsNaN) {
  EXPECT_TRUE(std::isnan(ConfusionMatrix().accuracy()));
  EXPECT_TRUE(std::isnan(ConfusionMatrix().balanced_accuracy()));
}

class DelaysTest : public ::testing::Test {
 protected:
  const std::vector<double> time{0.0, 0.1, 0.2, 0.3, 0.4};
  Delays delays;
};

TEST_F(DelaysTest, RunFromTheTrueOnset) {
  delays.add(time, std::vector{non_slip, non_slip, non_slip, incipient, gross}, 0.15);
  EXPECT_THAT(delays.delay, ElementsAre(DoubleNear(0.15, 1e-12)));
  EXPECT_EQ(delays.slipping, 1U);
  EXPECT_EQ(delays.early + delays.missed + delays.false_alarms, 0U);
}

TEST_F(DelaysTest, AFrameAtTheOnsetIsNotBeforeIt) {
  delays.add(time, std::vector{non_slip, non_slip, gross, gross, gross}, 0.2);
  EXPECT_THAT(delays.delay, ElementsAre(DoubleEq(0.0)));
}

TEST_F(DelaysTest, WhatIsCalledAlreadyIsEarlyAndAFalseAlarm) {
  delays.add(time, std::vector{non_slip, incipient, incipient, incipient, gross}, 0.15);
  EXPECT_THAT(delays.delay, IsEmpty());
  EXPECT_EQ(delays.early, 1U);
  EXPECT_EQ(delays.false_alarms, 1U);
}

TEST_F(DelaysTest, AFalseAlarmThatEndedLeavesTheDelay) {
  delays.add(time, std::vector{gross, non_slip, non_slip, gross, gross}, 0.15);
  EXPECT_THAT(delays.delay, ElementsAre(DoubleNear(0.15, 1e-12)));
  EXPECT_EQ(delays.false_alarms, 1U);
}

TEST_F(DelaysTest, WhatIsNeverCalledIsMissed) {
  delays.add(time, std::vector{non_slip, non_slip, non_slip, non_slip, non_slip}, 0.15);
  delays.add(time, std::vector{non_slip, non_slip, non_slip, non_slip, non_slip}, 0.5);  // after the last frame
  EXPECT_EQ(delays.missed, 2U);
  EXPECT_EQ(delays.slipping, 2U);
}

TEST_F(DelaysTest, WithoutSlipEveryCallIsFalse) {
  delays.add(time, std::vector{non_slip, non_slip, non_slip, non_slip, gross}, never);
  delays.add(time, std::vector{non_slip, non_slip, non_slip, non_slip, non_slip}, never);
  EXPECT_EQ(delays.false_alarms, 1U);
  EXPECT_EQ(delays.slipping, 0U);
  EXPECT_EQ(delays.sequences, 2U);
}

}  // namespace
}  // namespace slipbench::testing
