#include "tools/train/sequences.h"

#include <array>
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

struct DelaysTest : ::testing::Test {
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

TEST_F(DelaysTest, TheFirstCallDecides) {
  using Counts = std::array<std::size_t, 6>;  // detected, early, missed, false alarms; trials with slip; all trials
  const auto counts_of = [&](const std::vector<PadState>& called, double onset) {
    Delays one;
    one.add(time, called, onset);
    return Counts{one.delay.size(), one.early, one.missed, one.false_alarms, one.slipping, one.sequences};
  };
  const std::vector none(5, non_slip);
  constexpr Counts early{0, 1, 0, 0, 1, 1}, missed{0, 0, 1, 0, 1, 1};
  EXPECT_EQ(counts_of({non_slip, incipient, incipient, incipient, gross}, 0.15), early);
  EXPECT_EQ(counts_of({gross, non_slip, non_slip, gross, gross}, 0.15), early)
      << "what came and went leaves no delay of the next";
  EXPECT_EQ(counts_of({gross, non_slip, non_slip, non_slip, non_slip}, 0.15), early);
  EXPECT_EQ(counts_of(none, 0.15), missed);
  EXPECT_EQ(counts_of(none, 0.5), missed) << "after the last frame";
  EXPECT_EQ(counts_of({non_slip, non_slip, non_slip, non_slip, gross}, never), (Counts{0, 0, 0, 1, 0, 1}));
  EXPECT_EQ(counts_of(none, never), (Counts{0, 0, 0, 0, 0, 1}));
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
