// The calibration's hand motion: within its limits, spread over them, with consistent velocities.
#include "sim/api/motion.h"
#include "sim/motion/motion_catalogue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench::wander_test {
namespace {

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

std::unique_ptr<Motion> wander(const MotionKey& key, const Changes& changes = {}) {
  Parameters parameters = defaults_of(wander_motion().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return wander_motion().create(parameters, key);
}

// Compression [m], then along X and Y [m] and about X, Y and Z [rad], extracted from R = Rz Ry Rx.
std::array<double, 6> coordinates(const BodyState& pad) {
  const Eigen::Matrix3d& r = pad.pose.rotation;
  return {-pad.pose.position.z(),       pad.pose.position.x(), pad.pose.position.y(),
          std::atan2(r(2, 1), r(2, 2)), std::asin(-r(2, 0)),   std::atan2(r(1, 0), r(0, 0))};
}

TEST(Wander, StandsStillOverTheSurfaceUntilItsStart) {
  const auto motion = wander({7, 1}, {{"gap", 0.3e-3}, {"start", 0.4}});
  for (const double t : {0.0, 0.2, 0.4}) {
    const BodyState pad = motion->pad_at(t);
    EXPECT_EQ(pad.pose.position, Eigen::Vector3d(0.0, 0.0, 0.3e-3));
    EXPECT_TRUE(pad.pose.rotation.isIdentity(0.0));
    EXPECT_EQ(pad.velocity.norm() + pad.angular_velocity.norm(), 0.0);
  }
}

// A coordinate is limit * w * c with w symmetric over (-1, 1), c over (0, 1), both independent. So
// c has the quantiles of its share, and the median m of |w c| solves m (1 - ln m) = 1/2: m =
// 0.1867. 400 hands at instants 5 s apart, independent for waves of up to 0.5 Hz: 4,000 draws have
// a standard error of 0.0079 in a share, five of which are allowed. For g, a sum of eight sines and
// so not quite normal, 0.004 is added: its fourth moment is 3 - 3/16, which changes the share
// within |g| < 0.67 by less than that.
TEST(Wander, IsSpreadOverItsLimits) {
  const Changes limits{{"compression", 0.8e-3},
                       {"shear", std::vector<double>{0.5e-3, 0.25e-3}},
                       {"tilt", std::vector<double>{0.02, 0.03}},
                       {"twist", 0.06}};
  const std::array<double, 6> limit{0.8e-3, 0.5e-3, 0.25e-3, 0.02, 0.03, 0.06};
  std::array<int, 6> within{};
  int draws = 0;
  for (std::uint64_t trial = 0; trial < 400; ++trial) {
    const auto motion = wander({3, trial}, limits);
    for (int k = 1; k <= 10; ++k, ++draws) {
      const auto c = coordinates(motion->pad_at(5.0 * k));
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_LE(std::abs(c[i]), limit[i]);
        within[i] += std::abs(c[i]) < (i == 0 ? 0.5 : 0.1867) * limit[i] ? 1 : 0;
      }
      EXPECT_GT(c[0], 0.0);
    }
  }
  for (const int count : within) EXPECT_NEAR(count / static_cast<double>(draws), 0.5, 5.0 * 0.0079 + 0.004);
}

// Velocities are the poses' rates, by central differences: h = 10 us gives a relative error of
// omega^2 h^2/6 = 2e-9 and rounding of 1e-16/h = 1e-11.
TEST(Wander, VelocityIsTheRateOfItsPose) {
  const auto motion = wander({11, 2});
  const double h = 1e-5;
  double fastest = 0.0;
  for (double t = 0.55; t < 20.0; t += 0.37) {
    const BodyState before = motion->pad_at(t - h), now = motion->pad_at(t), after = motion->pad_at(t + h);
    EXPECT_NEAR((now.velocity - (after.pose.position - before.pose.position) / (2.0 * h)).norm(), 0.0, 1e-9);
    // R' R^T is the cross product with the angular velocity.
    const Eigen::Matrix3d spin = (after.pose.rotation - before.pose.rotation) / (2.0 * h) * now.pose.rotation.transpose();
    EXPECT_NEAR((now.angular_velocity - Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 0.0, 1e-7);
    const Eigen::Vector3d corner = now.pose.rotation * Eigen::Vector3d(9.5e-3, 9.5e-3, 0.0);
    fastest = std::max(fastest, (now.velocity + now.angular_velocity.cross(corner)).norm());
  }
  EXPECT_GT(fastest, 0.0);
  EXPECT_LE(fastest, motion->top_speed(std::hypot(9.5e-3, 9.5e-3)));
}

// A coordinate is a product of two waves of up to 0.5 Hz: at least 32 steps in a period of 1 Hz. No
// step turns by more than 3 deg.
TEST(Wander, LongestStepResolvesTheWaves) {
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    const auto motion = wander({3, trial});
    const double step = motion->longest_step();
    EXPECT_LE(step, 1.0 / 32.0);
    EXPECT_GT(step, 1e-3) << "a useful bound";
    for (double t = 0.0; t < 20.0; t += 0.01)
      ASSERT_LE(std::abs(motion->pad_at(t).angular_velocity.z()) * step, 3.0 * std::numbers::pi / 180.0);
  }
}

TEST(Wander, IsAnotherOneInEveryTrialAndForEverySeed) {
  const auto place = [](const MotionKey& key) { return wander(key)->pad_at(3.0).pose.position; };
  EXPECT_EQ(place({1, 0}), place({1, 0}));
  EXPECT_NE(place({1, 0}), place({1, 1}));
  EXPECT_NE(place({1, 0}), place({2, 0}));
}

TEST(Wander, TurnsWhereItMayTwist) {
  EXPECT_TRUE(wander({1, 0})->turns());
  EXPECT_FALSE(wander({1, 0}, {{"twist", 0.0}})->turns());
}

}  // namespace
}  // namespace slipbench::wander_test
