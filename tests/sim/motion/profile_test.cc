// One coordinate of a motion against closed forms of constant acceleration.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sim/core/random.h"
#include "sim/motion/profile.h"

namespace slipbench {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

// Times, distances and speeds below are sums of a few rounded numbers of size 1 s and 1 mm.
constexpr double rounding = 1e-15;

void expect_at(const Profile& profile, double t, double position, double velocity) {
  EXPECT_NEAR(profile.at(t).position, position, rounding) << "t " << t;
  EXPECT_NEAR(profile.at(t).velocity, velocity, rounding) << "t " << t;
}

TEST(Profile, StandsStillUntilMoved) {
  const Profile profile(0.5);
  EXPECT_TRUE(profile.at_rest_always());
  EXPECT_EQ(profile.top_speed(), 0.0);
  for (const double t : {-1e9, 0.0, 1e9}) {
    EXPECT_EQ(profile.at(t).position, 0.5);
    EXPECT_EQ(profile.at(t).velocity, 0.0);
  }
}

TEST(Profile, TrapezoidForthAndBack) {
  // 2 mm at 4 mm/s and 50 mm/s^2: ramps of 0.08 s and 0.16 mm each, 1.68 mm at full speed in 0.42
  // s, 0.58 s in all.
  for (const double sign : {1.0, -1.0}) {
    Profile profile(1e-3);
    profile.move(1.0, sign * 2e-3, 4e-3, 50e-3);
    EXPECT_NEAR(profile.end(), 1.58, rounding);
    EXPECT_NEAR(profile.top_speed(), 4e-3, rounding);
    expect_at(profile, 0.9, 1e-3, 0.0);
    expect_at(profile, 1.04, 1e-3 + sign * 0.04e-3, sign * 2e-3);  // half of the ramp: 50e-3 x 0.04^2/2
    expect_at(profile, 1.08, 1e-3 + sign * 0.16e-3, sign * 4e-3);
    expect_at(profile, 1.29, 1e-3 + sign * 1e-3, sign * 4e-3);  // the middle
    expect_at(profile, 1.54, 1e-3 + sign * 1.96e-3, sign * 2e-3);
    expect_at(profile, 1.6, 1e-3 + sign * 2e-3, 0.0);
    EXPECT_EQ(profile.at(1e6).velocity, 0.0) << "no creep is left";
  }
}

TEST(Profile, ShortWayIsATriangle) {
  // 0.1 mm at 50 mm/s^2 and up to 4 mm/s: the maximum is sqrt(a d) = 2.236 mm/s after sqrt(d/a) =
  // 44.7 ms, in the middle.
  const double a = 50e-3, d = 0.1e-3, half = std::sqrt(d / a);
  Profile profile(0.0);
  profile.move(0.0, d, 4e-3, a);
  EXPECT_NEAR(profile.end(), 2.0 * half, rounding);
  EXPECT_NEAR(profile.top_speed(), std::sqrt(a * d), rounding);
  expect_at(profile, half, 0.5 * d, std::sqrt(a * d));
  expect_at(profile, 0.5 * half, 0.125 * d, 0.5 * std::sqrt(a * d));
  expect_at(profile, 3.0 * half, d, 0.0);
}

TEST(Profile, InfiniteAccelerationJumps) {
  Profile profile(0.0);
  profile.move(0.25, -2e-3, 4e-3, inf);
  EXPECT_NEAR(profile.end(), 0.75, rounding);
  expect_at(profile, 0.25, 0.0, -4e-3);
  expect_at(profile, 0.5, -1e-3, -4e-3);
  expect_at(profile, 0.75, -2e-3, 0.0);
  profile.change_velocity(1.0, 3e-3, inf);
  expect_at(profile, 2.0, 1e-3, 3e-3);
}

TEST(Profile, ChangeStillAtWorkIsCutShort) {
  // Braked after 0.04 s of a ramp of 0.08 s, at 2 mm/s and 0.04 mm; braking takes another 0.04 mm.
  Profile profile(0.0);
  profile.change_velocity(0.0, 4e-3, 50e-3);
  profile.change_velocity(0.04, 0.0, 50e-3);
  expect_at(profile, 0.04, 0.04e-3, 2e-3);
  expect_at(profile, 0.06, 0.07e-3, 1e-3);
  expect_at(profile, 0.5, 0.08e-3, 0.0);
  EXPECT_NEAR(profile.top_speed(), 2e-3, rounding) << "the speed that was never reached does not count";
}

TEST(Profile, ReversalCrossesZeroAtTheLimit) {
  // From 4 mm/s to -4 mm/s at 50 mm/s^2: 0.16 s, after which it is back at the same position.
  Profile profile(0.0);
  profile.change_velocity(0.0, 4e-3, inf);
  profile.change_velocity(1.0, -4e-3, 50e-3);
  expect_at(profile, 1.08, 4e-3 + 0.16e-3, 0.0);
  expect_at(profile, 1.16, 4e-3, -4e-3);
  expect_at(profile, 2.16, 0.0, -4e-3);
}

TEST(Profile, ChangeToTheVelocityJustReachedHoldsIt) {
  // Reversing from 1/16 m/s at 1/4 m/s^2 from t = 1 the velocity is exactly 0 at t = 1.25.
  // Commanded to 0 there, it must stay 0.
  Profile profile(0.0);
  profile.change_velocity(0.0, 0.0625, inf);
  profile.change_velocity(1.0, -0.0625, 0.25);
  profile.change_velocity(1.25, 0.0, 0.25);
  const double position = 0.0625 + 0.25 * 0.0625 / 2.0;
  expect_at(profile, 1.25, position, 0.0);
  expect_at(profile, 1.5, position, 0.0);
  expect_at(profile, 10.0, position, 0.0);
}

TEST(Profile, AnySequenceOfChangesIsContinuousAndWithinItsLimit) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    RandomStream draw(seed, 0, "profile");
    const double limit = draw.uniform(0.01, 0.2);
    Profile profile(draw.uniform(-1e-3, 1e-3));
    double t = 0.0, fastest = 0.0, last = 0.0;
    for (int change = 0; change < 6; ++change) {
      profile.change_velocity(t, last = draw.uniform(-8e-3, 8e-3), limit);
      t += draw.uniform(0.0, 0.2);
    }
    const double h = 1e-4;
    for (double s = 0.0; s < 1.5; s += h) {
      const ProfilePoint a = profile.at(s), b = profile.at(s + h);
      fastest = std::max(fastest, std::abs(a.velocity));
      ASSERT_LE(std::abs(b.velocity - a.velocity), limit * h * (1.0 + 1e-9));
      // Over h the velocity lies between both ends except for one reversal inside, which adds at
      // most limit h/2.
      ASSERT_LE(std::abs(b.position - a.position - 0.5 * h * (a.velocity + b.velocity)), 0.25 * limit * h * h * (1.0 + 1e-9));
    }
    EXPECT_LE(fastest, profile.top_speed() * (1.0 + 1e-12));
    EXPECT_GE(fastest, profile.top_speed() - limit * h);
    EXPECT_EQ(profile.at(profile.end() + 1.0).velocity, last);
  }
}

// A step with a reversal loses at most a h^2/4, and at most h v, of the path. 1 % of a stroke of 10
// mm is 0.1 mm.
TEST(Profile, AStepWithAReversalLosesLittleOfTheStroke) {
  const auto strokes = [](double acceleration) {
    Profile profile(0.0);
    profile.move(1.0, 10e-3, 4e-3, acceleration);
    profile.move(profile.end(), -10e-3, 4e-3, acceleration);
    return profile.step_per_reversal();
  };
  EXPECT_NEAR(strokes(50e-3), std::sqrt(4.0 * 0.1e-3 / 50e-3), 1e-12);
  EXPECT_NEAR(strokes(inf), 0.1e-3 / 4e-3, 1e-12);
  // At 16 mm/s^2: 2 mm until 8 mm/s are reached at 0.5 s, 4 mm until 1 s, 2 mm until rest.
  Profile turns(0.0);
  turns.change_velocity(0.0, 8e-3, 16e-3);
  turns.change_velocity(1.0, -8e-3, 16e-3);
  EXPECT_NEAR(turns.step_per_reversal(), std::sqrt(4.0 * 0.01 * 8e-3 / 16e-3), 1e-12);
  Profile stops(0.0);
  stops.move(0.1, 3e-3, 4e-3, 50e-3);
  EXPECT_EQ(stops.step_per_reversal(), inf);
}

TEST(Profile, MovesOnFromAMoveUnderWay) {
  // From 1 m/s at 2 m/s^2 to 3 m further: without a limit the maximum v with v^2 - 1/2 = a d = 6
  // would be 2.55 m/s. Up to 2 m/s: 0.5 s and 0.75 m, down again 1 s and 1 m, between them 1.25 m
  // in 0.625 s.
  Profile profile(0.0);
  profile.change_velocity(0.0, 1.0, inf);
  profile.move_to(1.0, 4.0, 2.0, 2.0);
  EXPECT_NEAR(profile.end(), 1.0 + 0.5 + 0.625 + 1.0, 1e-14);
  expect_at(profile, 1.5, 1.75, 2.0);
  expect_at(profile, 2.125, 3.0, 2.0);
  expect_at(profile, 10.0, 4.0, 0.0);
  // Slower than the current speed: from 1 m/s to 0.5 m/s in 0.25 s and 0.1875 m, and so on.
  Profile slower(0.0);
  slower.change_velocity(0.0, 1.0, inf);
  slower.move_to(1.0, 4.0, 0.5, 2.0);
  expect_at(slower, 1.25, 1.1875, 0.5);
  expect_at(slower, 100.0, 4.0, 0.0);
}

TEST(Profile, BrakesFirstWhereTheMoveLeadsPastTheTargetOrAway) {
  // From 1 m/s at 2 m/s^2 it stops after 0.5 s and 0.25 m. A target 0.1 m ahead, or 1 m behind, is
  // reached from there.
  for (const double target : {1.1, 0.0}) {
    Profile profile(0.0);
    profile.change_velocity(0.0, 1.0, inf);
    profile.move_to(1.0, target, 10.0, 2.0);
    expect_at(profile, 1.5, 1.25, 0.0);
    EXPECT_NEAR(profile.end(), 1.5 + 2.0 * std::sqrt((1.25 - target) / 2.0), 1e-14);
    expect_at(profile, 100.0, target, 0.0);
  }
}

TEST(Profile, MovesToFromRestAsMove) {
  Profile to(0.25), by(0.25);
  to.move_to(1.0, 0.75, 0.4, 2.0);
  by.move(1.0, 0.5, 0.4, 2.0);
  for (double t = 0.9; t < 3.0; t += 0.1) expect_at(to, t, by.at(t).position, by.at(t).velocity);
}

}  // namespace
}  // namespace slipbench
