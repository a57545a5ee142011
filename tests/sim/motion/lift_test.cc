// The arm of a grasp: position, speed and timing.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sim/api/motion.h"
#include "sim/motion/motion_catalogue.h"

namespace slipbench {
namespace {

constexpr double pi = std::numbers::pi;

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

Parameters parameters(const Changes& changes) {
  Parameters result = defaults_of(lift_motion().about.parameters);
  for (const auto& [name, value] : changes) result.set(name, value);
  return result;
}

std::unique_ptr<Motion> lift(const Changes& changes = {}) { return lift_motion().create(parameters(changes), {}); }

void expect_vector(const Eigen::Vector3d& found, const Eigen::Vector3d& expected, double tolerance) {
  EXPECT_LT((found - expected).norm(), tolerance) << found.transpose() << " instead of " << expected.transpose();
}

TEST(Lift, WaitsAndRisesOnATrapezoid) {
  // 100 mm at 43 mm/s and 400 mm/s^2: ramps of 43/400 = 0.1075 s, in all 100/43 + 0.1075 s; half of
  // the distance in half of the time.
  const auto motion = lift();
  const double end = 1.5 + 0.1 / 0.043 + 0.1075;
  const LiftTimes times = lift_times(parameters({}));
  EXPECT_EQ(times.start, 1.5);
  EXPECT_NEAR(times.end, end, 1e-14);
  for (const double t : {0.0, 1.5}) {
    EXPECT_EQ(motion->pad_at(t).pose.position, Eigen::Vector3d::Zero());
    EXPECT_EQ(motion->pad_at(t).velocity, Eigen::Vector3d::Zero());
  }
  expect_vector(motion->pad_at(1.55).velocity, {0.0, 0.0, 0.02}, 1e-15);         // 0.4 x 0.05
  expect_vector(motion->pad_at(1.55).pose.position, {0.0, 0.0, 0.5e-3}, 1e-15);  // 0.2 x 0.05^2
  expect_vector(motion->pad_at(0.5 * (1.5 + end)).pose.position, {0.0, 0.0, 0.05}, 1e-15);
  expect_vector(motion->pad_at(0.5 * (1.5 + end)).velocity, {0.0, 0.0, 0.043}, 1e-15);
  for (const double t : {end, 100.0}) {
    expect_vector(motion->pad_at(t).pose.position, {0.0, 0.0, 0.1}, 1e-15);
    EXPECT_EQ(motion->pad_at(t).velocity, Eigen::Vector3d::Zero());
  }
  EXPECT_FALSE(motion->turns());
  EXPECT_NEAR(motion->top_speed(0.1), 0.043, 1e-15);
}

TEST(Lift, GoesSidewaysAfterIt) {
  // 50 mm along [0.6, 0.8] at 0.1 m/s and 0.1 m/s^2, after 100 mm up: a triangular profile takes
  // 1.414 s and does not reach the top speed.
  const auto motion = lift({{"speed", 0.1}, {"acceleration", 0.1}, {"sideways", std::vector{0.03, 0.04}}});
  const double risen = 1.5 + 2.0;  // 100 mm: sqrt(a d) = 0.1 m/s just reached
  const double half = std::sqrt(0.05 / 0.1);
  expect_vector(motion->pad_at(risen).pose.position, {0.0, 0.0, 0.1}, 1e-15);
  expect_vector(motion->pad_at(risen + half).pose.position, {0.015, 0.02, 0.1}, 1e-15);
  expect_vector(motion->pad_at(risen + half).velocity, std::sqrt(0.1 * 0.05) * Eigen::Vector3d(0.6, 0.8, 0.0), 1e-15);
  expect_vector(motion->pad_at(risen + 2.0 * half).pose.position, {0.03, 0.04, 0.1}, 1e-15);
}

TEST(Lift, TiltsAboutOneAxis) {
  // 50 deg about [0.6, 0.8, 0] at 50 deg/s, without a ramp: 1 s from the end of a lift by 0.
  const double rate = 50.0 * pi / 180.0;
  const auto motion = lift({{"distance", 0.0},
                            {"tilt", std::vector{0.6 * rate, 0.8 * rate}},
                            {"tilt_speed", rate},
                            {"tilt_acceleration", 1e9 * rate}});
  EXPECT_TRUE(motion->turns());
  const BodyState half = motion->pad_at(2.0);
  expect_vector(half.angular_velocity, rate * Eigen::Vector3d(0.6, 0.8, 0.0), 1e-9);
  const Eigen::AngleAxisd turn(half.pose.rotation);
  EXPECT_NEAR(turn.angle(), 0.5 * rate, 1e-8);
  expect_vector(turn.axis(), {0.6, 0.8, 0.0}, 1e-9);
  EXPECT_NEAR(Eigen::AngleAxisd(motion->pad_at(9.0).pose.rotation).angle(), rate, 1e-12);
  EXPECT_NEAR(motion->top_speed(0.1), 0.1 * rate, 1e-9);
}

TEST(Lift, ShakesWholeCyclesFromRestToRest) {
  // 2 cycles of 4 Hz between 0 and 10 mm up, from 1.5 s on; the top speed, 10 mm pi 4 Hz, at a
  // quarter of a cycle.
  const auto motion = lift(
      {{"distance", 0.0}, {"shake", std::vector{0.0, 0.0, 0.01}}, {"shake_frequency", 4.0}, {"shake_cycles", std::int64_t{2}}});
  expect_vector(motion->pad_at(1.5).pose.position, {0.0, 0.0, 0.0}, 1e-18);
  expect_vector(motion->pad_at(1.5 + 0.0625).pose.position, {0.0, 0.0, 0.005}, 1e-15);
  expect_vector(motion->pad_at(1.5 + 0.0625).velocity, {0.0, 0.0, 0.01 * pi * 4.0}, 1e-15);
  expect_vector(motion->pad_at(1.5 + 0.125).pose.position, {0.0, 0.0, 0.01}, 1e-15);
  expect_vector(motion->pad_at(1.5 + 0.125).velocity, {0.0, 0.0, 0.0}, 1e-15);
  for (const double t : {2.0, 5.0}) {
    EXPECT_EQ(motion->pad_at(t).pose.position, Eigen::Vector3d::Zero());
    EXPECT_EQ(motion->pad_at(t).velocity, Eigen::Vector3d::Zero());
  }
  EXPECT_NEAR(motion->top_speed(0.1), 0.01 * pi * 4.0, 1e-15);
}

TEST(Lift, LongestStepResolvesShakingAndTilt) {
  EXPECT_TRUE(std::isinf(lift({})->longest_step()));
  // 32 steps in a period of 4 Hz; 3 deg at 360 deg/s.
  EXPECT_NEAR(lift({{"shake", std::vector{0.0, 0.0, 0.01}}, {"shake_frequency", 4.0}})->longest_step(), 1.0 / 128.0, 1e-12);
  const double turn = 2.0 * pi;
  EXPECT_NEAR(lift({{"tilt", std::vector{1.0, 0.0}}, {"tilt_speed", turn}, {"tilt_acceleration", 1e9}})->longest_step(),
              1.0 / 120.0, 1e-12);
}

TEST(Lift, VelocityIsTheDerivativeOfThePose) {
  const auto motion = lift(
      {{"sideways", std::vector{0.03, -0.02}}, {"tilt", std::vector{0.3, 0.2}}, {"shake", std::vector{0.002, 0.001, 0.003}}});
  // Central differences of step 1e-5 s: the third derivative of the shake, 0.003/2 (10 pi)^3 m/s^3,
  // times h^2/6 is 1e-9 m/s.
  constexpr double h = 1e-5;
  for (double t = 0.013; t < 12.0; t += 0.0717) {
    const BodyState before = motion->pad_at(t - h), now = motion->pad_at(t), after = motion->pad_at(t + h);
    expect_vector((after.pose.position - before.pose.position) / (2.0 * h), now.velocity,
                  3e-6);  // at a jump of the acceleration a h/4
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(after.pose.rotation * before.pose.rotation.transpose()));
    expect_vector(turn.angle() / (2.0 * h) * turn.axis(), now.angular_velocity, 1e-5);
  }
}

}  // namespace
}  // namespace slipbench
