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

TEST(Decade, RoundsToSignificantDigits) {
  EXPECT_EQ(rounded_to_digits(0.00123456, 3), 0.00123);
  EXPECT_EQ(rounded_to_digits(-98765.0, 2), -99e3);
  EXPECT_EQ(rounded_to_digits(0.0, 3), 0.0);
  EXPECT_EQ(rounded_to_digits(INFINITY, 3), INFINITY);
  EXPECT_EQ(rounded_to_digits(1.79e308, 1), 1.79e308) << "2e308 is beyond a double";
}

}  // namespace
}  // namespace slipbench
