#include "sim/simulation/tick_times.h"

#include <cstddef>

#include <gtest/gtest.h>

namespace slipbench {
namespace {

TEST(TickTimes, AreQuotientsOfWholeNumbersWhereTheStepIsAnNthOfASecond) {
  const TickTimes milliseconds(0.001), tenths(0.0001);
  for (std::size_t k = 0; k < 60'000; ++k) ASSERT_EQ(milliseconds.at(k), tenths.at(10 * k)) << k;
  EXPECT_EQ(milliseconds.at(9), 0.009);  // the double next to 9/1000, as decimal text is read
  EXPECT_NE(9.0 * 0.001, 0.009);         // which is why
  EXPECT_EQ(TickTimes(1.0 / 2400.0).at(24), 0.01);
}

TEST(TickTimes, AreMultiplesOfAStepThatIsNone) {
  EXPECT_EQ(TickTimes(0.0003).at(7), 7.0 * 0.0003);  // 3,333.3 a second
  EXPECT_EQ(TickTimes(2.0).at(3), 6.0);
}

}  // namespace
}  // namespace slipbench
