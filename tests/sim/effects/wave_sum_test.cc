#include "sim/effects/wave_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "sim/core/random.h"

namespace slipbench {
namespace {

TEST(WaveSum, IsTheSumOfCosines) {
  constexpr std::size_t points = 64;
  RandomStream stream(1, 0, "waves");
  std::vector<std::complex<double>> waves(20);
  for (std::complex<double>& wave : waves) wave = {stream.normal(), stream.normal()};
  const std::vector<double> heights = WaveSum(points).at_points(waves);
  ASSERT_EQ(heights.size(), points);
  for (std::size_t k = 0; k < points; ++k) {
    double expected = 0.0;
    for (std::size_t n = 0; n < waves.size(); ++n)
      expected += std::real(waves[n] * std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(n * k) / points));
    EXPECT_NEAR(heights[k], expected, 1e-12) << k;
  }
}

TEST(WaveSum, RefusesWhatItCannotSum) {
  EXPECT_THROW(WaveSum(48), std::logic_error);
  EXPECT_THROW((void)WaveSum(16).at_points(std::vector<std::complex<double>>(17)), std::logic_error);
}

}  // namespace
}  // namespace slipbench
