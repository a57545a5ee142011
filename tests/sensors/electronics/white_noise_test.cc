// White noise of many values.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

TEST(WhiteNoisePart, IsNormalAndForgetsEverything) {
  // Standard errors for n draws: sqrt(2/n) of the mean square, sqrt(96/n) of the fourth moment,
  // 1/sqrt(n) of a product of two.
  const auto y = outputs({part("white_noise", 2.0)}, two_values_a_source(many), 0.0F, {0.0, 0.001});
  double mean = 0.0, square = 0.0, fourth = 0.0, lag = 0.0, beside = 0.0;
  const double n = static_cast<double>(many);
  for (std::size_t v = 0; v < many; ++v) {
    const double x = 0.5 * static_cast<double>(y[0][v]);
    mean += x / n;
    square += x * x / n;
    fourth += x * x * x * x / n;
    lag += x * 0.5 * static_cast<double>(y[1][v]) / n;
    beside += x * 0.5 * static_cast<double>(y[0][(v + 1) % many]) / n;
    ASSERT_NEAR(y[0][many + v], 3.0F * y[0][v], 1e-5F) << "another value of the same source, three times as noisy";
  }
  EXPECT_NEAR(mean, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(square, 1.0, 5.0 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth, 3.0, 5.0 * std::sqrt(96.0 / n));
  EXPECT_NEAR(lag, 0.0, 5.0 / std::sqrt(n));
  EXPECT_NEAR(beside, 0.0, 5.0 / std::sqrt(n));
}

TEST(WhiteNoisePart, GoesOnFromItsMemory) {
  const SignalModel model = two_values_a_source(7);
  Electronics lasting({part("white_noise")}, model, default_key), fresh({part("white_noise")}, model, default_key);
  std::vector<float> a(14), b(14);
  for (int k = 0; k < 3; ++k) lasting.apply(a, 0.001 * k);
  std::ranges::copy(lasting.memory()[0], fresh.memory()[0].begin());
  std::ranges::fill(a, 0.0F);
  lasting.apply(a, 0.003);
  fresh.apply(b, 0.003);
  EXPECT_EQ(a, b);
  EXPECT_NE(a[0], 0.0F);
}

}  // namespace
}  // namespace slipbench
