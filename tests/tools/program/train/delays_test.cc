#include "tools/program/train/sequences.h"

#include <limits>
#include <vector>

#include "tests/expect.h"

namespace slipbench::testing {
namespace {

using ::testing::DoubleEq;

constexpr PadState non_slip = PadState::non_slip;
constexpr PadState incipient = PadState::incipient;
constexpr PadState gross = PadState::gross;
constexpr double never = std::numeric_limits<double>::quiet_NaN();

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

TEST_F(DelaysTest, WhatIsCalledAlreadyIsEarly) {
  delays.add(time, std::vector{non_slip, incipient, incipient, incipient, gross}, 0.15);
  EXPECT_THAT(delays.delay, IsEmpty());
  EXPECT_EQ(delays.early, 1U);
  EXPECT_EQ(delays.slipping, 1U);
  EXPECT_EQ(delays.false_alarms, 0U);
}

// The first call decides: one that came and went leaves no delay of the next.
TEST_F(DelaysTest, WhatWasCalledAndWithdrawnIsEarlyToo) {
  delays.add(time, std::vector{gross, non_slip, non_slip, gross, gross}, 0.15);
  delays.add(time, std::vector{gross, non_slip, non_slip, non_slip, non_slip}, 0.15);
  EXPECT_THAT(delays.delay, IsEmpty());
  EXPECT_EQ(delays.early, 2U);
  EXPECT_EQ(delays.missed, 0U);
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
  EXPECT_EQ(delays.early + delays.missed + delays.slipping, 0U);
  EXPECT_EQ(delays.sequences, 2U);
}

TEST_F(DelaysTest, AddUp) {
  delays.add(time, std::vector{non_slip, non_slip, gross, gross, gross}, 0.2);
  delays.add(time, std::vector{gross, non_slip, gross, gross, gross}, 0.2);
  Delays sum = delays;
  sum.add(delays);
  EXPECT_EQ(sum.delay.size(), 2U);
  EXPECT_EQ(sum.early, 2U);
  EXPECT_EQ(sum.slipping, 4U);
}

}  // namespace
}  // namespace slipbench::testing
