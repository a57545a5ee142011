#include "sim/core/math/decade.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace slipbench {
namespace {

TEST(Decade, PowersAreThoseThatTextGives) {
  for (int exponent = -22; exponent <= 22; ++exponent)
    EXPECT_EQ(power_of_ten(exponent), std::stod("1e" + std::to_string(exponent))) << exponent;
  EXPECT_EQ(power_of_ten(2'000'000'000), INFINITY);
  EXPECT_EQ(power_of_ten(-2'000'000'000), 0.0);
}

TEST(Decade, ChangesAtThePowerItself) {
  for (int exponent = -200; exponent <= 200; ++exponent) {
    const double power = power_of_ten(exponent);
    EXPECT_EQ(decade_of(power), exponent);
    EXPECT_EQ(decade_of(std::nextafter(power, 0.0)), exponent - 1);
    EXPECT_EQ(decade_of(9.99 * power), exponent);
  }
}

}  // namespace
}  // namespace slipbench
