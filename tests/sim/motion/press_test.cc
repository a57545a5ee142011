// The press: where the pad is, how fast, when; and what it refuses.
#include "sim/motion/motion.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/core/error.h"

namespace slipbench::press_test {
namespace {

std::unique_ptr<Motion> press(const std::vector<std::pair<std::string, Parameters::Value>>& changes) {
  Parameters parameters = defaults_of(press_motion().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return press_motion().create(parameters, {});
}

// 0.5 mm of gap and 0.8 mm of compression at 1 mm/s and 50 mm/s2: 1.3 s + 0.02 s, half of the way in half of the time. The retreat at
// 0.03 mm/s has reached its speed after 0.6 ms and 9 nm.
TEST(Press, PressesHoldsAndRetreats) {
  const auto motion = press({{"begin", 1.0}, {"retreat", 5.0}});
  const auto height = [&](double t) { return motion->pad_at(t).pose.position.z(); };
  EXPECT_EQ(height(1.0), 0.5e-3);
  EXPECT_NEAR(height(1.66), -0.15e-3, 1e-15);
  EXPECT_NEAR(motion->pad_at(1.66).velocity.z(), -1e-3, 1e-15);
  EXPECT_NEAR(height(2.32), -0.8e-3, 1e-15);
  EXPECT_NEAR(height(5.0), -0.8e-3, 1e-15);
  EXPECT_NEAR(motion->pad_at(10.0).velocity.z(), 0.03e-3, 1e-15);
  EXPECT_NEAR(height(10.0), -0.8e-3 + 0.03e-3 * 5.0 - 9e-9, 1e-14);
  // 1.3 mm take 43.33 s and 0.6 ms; there it rests.
  EXPECT_NEAR(height(60.0), 0.5e-3, 1e-15);
  EXPECT_EQ(motion->pad_at(60.0).velocity.norm(), 0.0);
  EXPECT_FALSE(motion->turns());
  EXPECT_NEAR(motion->top_speed(0.1), 1e-3, 1e-15);
}

TEST(Press, StandsWhereItIsTold) {
  const auto motion = press({{"offset", std::vector<double>{31.75e-3, -2e-3}},
                             {"yaw", std::numbers::pi / 2.0},
                             {"tilt", std::vector<double>{0.1, 0.0}}});
  const Pose pose = motion->pad_at(0.0).pose;
  EXPECT_EQ(pose.position, Eigen::Vector3d(31.75e-3, -2e-3, 0.5e-3));
  // X to Y by the yaw; Y, which the tilt lifts by 0.1 rad, to -X and up.
  EXPECT_NEAR((pose.rotation.col(0) - Eigen::Vector3d(0.0, 1.0, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((pose.rotation.col(1) - Eigen::Vector3d(-std::cos(0.1), 0.0, std::sin(0.1))).norm(), 0.0, 1e-15);
}

TEST(Press, RefusesARetreatBeforeItHasPressed) {
  try {
    press({{"retreat", 1.3}});
    FAIL();
  } catch (const SceneValueError& error) {
    EXPECT_NE(std::string(error.what()).find("pressing ends at 1.32 s"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace slipbench::press_test
