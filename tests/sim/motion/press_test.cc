// The press: position, speed, timing and refusals.
#include "sim/api/motion.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "sim/motion/guided.h"
#include "sim/motion/motion_catalogue.h"
#include "tests/expect.h"

namespace slipbench::press_test {
namespace {

std::unique_ptr<Motion> press(const std::vector<std::pair<std::string, Parameters::Value>>& changes) {
  Parameters parameters = defaults_of(press_motion().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return press_motion().create(parameters, {});
}

// 0.5 mm of gap and 0.8 mm of compression at 1 mm/s and 50 mm/s2: 1.3 s + 0.02 s, half of the
// distance in half of the time. The retreat reaches its 0.03 mm/s after 0.6 ms and 9 nm.
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
  // 1.3 mm take 43.33 s and 0.6 ms; then the pad rests.
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
  EXPECT_THAT(refusal_of<SceneValueError>([] { press({{"retreat", 1.3}}); }), mentions({"pressing", "1.32 s"}));
}

// The arm commanded by a controller: trapezoids from the instants of the commands.

// 8 ms latency, 0.2 m/s2, at most 0.1 m/s.
Guided arm() { return Guided(defaults_of(guided_motion().about.parameters)); }

TEST(Guided, RestsUntilTold) {
  const Guided resting = arm();
  EXPECT_EQ(resting.pad_at(1e3).pose.position, Eigen::Vector3d::Zero());
  EXPECT_EQ(resting.pad_at(1e3).velocity, Eigen::Vector3d::Zero());
  EXPECT_TRUE(std::isinf(resting.lift_start()));
  EXPECT_FALSE(resting.turns());
}

// 10 mm/s up, written at 1 s: after the latency 50 ms at 0.2 m/s2, 0.25 mm, then 10 mm/s.
TEST(Guided, EachCommandIsARampAfterTheLatency) {
  Guided moving = arm();
  moving.write(1.0, {.sideways = 0.0, .up = 10e-3});
  EXPECT_DOUBLE_EQ(moving.lift_start(), 1.008);
  EXPECT_EQ(moving.pad_at(1.008).velocity.z(), 0.0);
  EXPECT_NEAR(moving.pad_at(1.033).velocity.z(), 5e-3, 1e-15);
  EXPECT_NEAR(moving.pad_at(1.058).pose.position.z(), 0.25e-3, 1e-15);
  EXPECT_NEAR(moving.pad_at(2.058).pose.position.z(), 10.25e-3, 1e-14);
  // Repeating the command changes nothing. Sideways is a separate axis: -20 mm/s takes 100 ms and 1
  // mm.
  moving.write(2.0, {.sideways = 0.0, .up = 10e-3});
  moving.write(2.05, {.sideways = -20e-3, .up = 10e-3});
  EXPECT_NEAR(moving.pad_at(3.158).pose.position.y(), -21e-3, 1e-14);
  EXPECT_NEAR(moving.pad_at(3.158).pose.position.z(), 21.25e-3, 1e-14);
  EXPECT_EQ(moving.pad_at(3.158).pose.position.x(), 0.0);
  EXPECT_DOUBLE_EQ(moving.lift_start(), 1.008);
}

// Stopped in the middle of the ramp, after 25 ms and 0.0625 mm, it brakes for the same time and
// distance.
TEST(Guided, ACommandCutsTheRampOfTheLastOneShort) {
  Guided stopped = arm();
  stopped.write(0.0, {.sideways = 0.0, .up = 10e-3});
  stopped.write(0.025, {});
  EXPECT_NEAR(stopped.pad_at(0.033).velocity.z(), 5e-3, 1e-15);
  EXPECT_NEAR(stopped.pad_at(10.0).pose.position.z(), 0.125e-3, 1e-15);
  EXPECT_EQ(stopped.pad_at(10.0).velocity.z(), 0.0);
}

TEST(Guided, RefusesWhatIsTooFast) {
  Guided slow = arm();
  EXPECT_NO_THROW(slow.write(0.0, {.sideways = -0.1, .up = 0.1}));
  for (const double speed : {0.101, -0.101, std::nan("")}) {
    EXPECT_THROW(slow.write(0.0, {.sideways = 0.0, .up = speed}), SceneValueError);
    EXPECT_THROW(slow.write(0.0, {.sideways = speed, .up = 0.0}), SceneValueError);
  }
  EXPECT_THAT(scene_refusal_of([&] { slow.write(0.5, {.sideways = 0.0, .up = 0.2}); }),
              refused_at("motion.top_speed", {"0.2 m/s", "0.5 s", "0.1 m/s"}));
}

}  // namespace
}  // namespace slipbench::press_test
