#include "tools/program/calibrate/search.h"

#include <cmath>

#include <gtest/gtest.h>

namespace slipbench::calibrate::disturbances_test {
namespace {

using Eigen::MatrixXd;

// Two units of two components, 50 stretches, which begin at 0; the first unit carries sines, the second twice as much.
Columns two_units() {
  ChannelPlace place{.sensor = "pad", .channel = "force", .unit = "N", .names = {"x", "y"}};
  place.units = 2;
  place.components = 2;
  return {{place}, 4};
}

MatrixXd signal() {
  MatrixXd wave(50, 4);
  for (int t = 0; t < 50; ++t) {
    wave(t, 0) = std::sin(0.3 * t);
    wave(t, 1) = std::cos(0.5 * t) - 1.0;
    wave.block(t, 2, 1, 2) = 2.0 * wave.block(t, 0, 1, 2);
  }
  return wave;
}

// By device d the x of the units have gains 1 + a and 1 - a, a coupling b to y, offsets c.
MatrixXd read(double a, double b, double c) {
  const MatrixXd s = signal();
  MatrixXd y = s;
  y.col(0) = (1.0 + a) * s.col(0) + b * s.col(1);
  y.col(2) = (1.0 - a) * s.col(2) + b * s.col(3);
  y.col(0).array() += c;
  y.col(2).array() -= c;
  return y;
}

Disturbances learned() {
  return {two_units(), {{read(0.1, 0.02, 0.3)}, {read(-0.1, -0.02, -0.3)}}, {{signal()}, {signal()}}, 1e-4};
}

// Gains of 1.1 and 0.9 scatter by 0.1, and so on; y has none of all.
TEST(Disturbances, AreLearned) {
  const Disturbances disturbances = learned();
  const Disturbance& x = disturbances.by_component()[0];
  EXPECT_NEAR(x.gain_sd, 0.1, 1e-4);
  EXPECT_NEAR(x.coupling_sd, 0.02, 1e-4);
  EXPECT_NEAR(x.offset_sd, 0.3, 1e-3);
  const Disturbance& y = disturbances.by_component()[1];
  EXPECT_LT(y.gain_sd, 1e-4);
  EXPECT_LT(y.offset_sd, 1e-3);
}

// The unit that carries twice as much has four times the weight: gains of 1.1 and 1 - 0.1/4 have the mean 1.
TEST(Disturbances, ExplainGainsCouplingsAndOffsets) {
  const MatrixXd s = signal();
  MatrixXd y = s;
  y.col(0) = 1.1 * s.col(0) + 0.02 * s.col(1);
  y.col(2) = (1.0 - 0.1 / 4.0) * s.col(2);
  y.col(0).array() += 0.3;
  const Distance distance = learned().distance({y}, {s});
  EXPECT_NEAR(distance.gain(0), 1.1, 1e-3);
  EXPECT_NEAR(distance.gain(2), 0.975, 1e-3);
  EXPECT_NEAR(distance.offset(0, 0), 0.3, 1e-3);
  EXPECT_LT((distance.explained[0] - y).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(distance.residual.size(), static_cast<Eigen::Index>(distance.group.size()));
}

// What both units share is no gain: the readings stay where they are, 10 % above the signal. The couplings, of which the prior allows 0.02, take up what
// of a sine looks like a cosine in 50 samples, some percent of the difference.
TEST(Disturbances, LeaveWhatAllGainsShare) {
  const MatrixXd s = signal();
  MatrixXd y = s;
  y.col(0) *= 1.1;
  y.col(2) *= 1.1;
  const Disturbances disturbances = learned();
  const Distance distance = disturbances.distance({y}, {s});
  EXPECT_NEAR(distance.gain(0), 1.0, 1e-3);
  EXPECT_NEAR((distance.explained[0].col(0) - y.col(0)).norm() / s.col(0).norm(), 0.1, 5e-3);
  EXPECT_NEAR(disturbances.common_gain({y}, {s})(2), 1.1, 1e-3);
}

}  // namespace
}  // namespace slipbench::calibrate::disturbances_test
