#include "sim/effects/skin/bessel.h"

#include <gtest/gtest.h>

#include <cmath>

namespace slipbench {
namespace {

// Covers both sides of the change of method at 25.
TEST(Bessel, IsTheStandardLibrarys) {
  for (double x = 0.0; x < 60.0; x += 0.0625) {
    const auto [j0, j2] = bessel(x);
    EXPECT_NEAR(j0, std::cyl_bessel_j(0.0, x), 2e-14) << x;
    EXPECT_NEAR(j2, std::cyl_bessel_j(2.0, x), 2e-14) << x;
  }
}

}  // namespace
}  // namespace slipbench
