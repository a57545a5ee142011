// The stage: position, speed, timing and refusals.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/api/motion.h"
#include "sim/core/random.h"
#include "sim/motion/motion_catalogue.h"
#include "tests/expect.h"

namespace slipbench::stage_test {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity(), pi = std::numbers::pi;

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

std::unique_ptr<Motion> stage(const Changes& changes = {}) {
  const MotionKind& kind = motion_catalogue().front();
  Parameters parameters = defaults_of(kind.about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return kind.create(parameters, {});
}

std::string refusal(const Changes& changes) {
  return refusal_of([&] { stage(changes); });
}

double height(const Motion& motion, double t) { return motion.pad_at(t).pose.position.z(); }

TEST(MotionCatalogue, EntriesAreDocumentedAndTheirDefaultsWork) {
  for (const MotionKind& kind : motion_catalogue()) {
    EXPECT_FALSE(kind.about.summary.empty() || kind.about.law.empty() || kind.about.source.empty()) << kind.about.name;
    for (const ParameterSpec& parameter : kind.about.parameters) {
      EXPECT_FALSE(parameter.doc.empty() || parameter.source.empty()) << kind.about.name << "." << parameter.name;
    }
    EXPECT_NE(kind.create(defaults_of(kind.about.parameters), {}), nullptr);
  }
  EXPECT_EQ(motion_catalogue().front().about.name, "stage");
}

TEST(Stage, PressesFromTheGapToTheCompressionAndLiftsOff) {
  // 1.5 mm at 4 mm/s and 50 mm/s^2: 1.5/4 + 4/50 = 0.455 s; half of the distance in half of the
  // time.
  const auto motion = stage({{"retract", 5.0}});
  EXPECT_NEAR(height(*motion, 0.0), 0.5e-3, 1e-18);
  EXPECT_NEAR(height(*motion, 0.2275), -0.25e-3, 1e-15);
  EXPECT_NEAR(motion->pad_at(0.2275).velocity.z(), -4e-3, 1e-15);
  for (const double t : {0.455, 1.0, 5.0}) {
    EXPECT_NEAR(height(*motion, t), -1e-3, 1e-15);
    EXPECT_NEAR(motion->pad_at(t).velocity.z(), 0.0, 1e-12);
  }
  EXPECT_NEAR(height(*motion, 5.2275), -0.25e-3, 1e-15);
  EXPECT_NEAR(height(*motion, 5.455), 0.5e-3, 1e-15);
  EXPECT_NEAR(height(*motion, 100.0), 0.5e-3, 1e-15);
}

TEST(Stage, TallestTipReachesTheCompressionWhateverTheTilt) {
  // The middle pillar's tip is the pad's origin: pressed in by the compression at any rotation.
  for (const double about_x : {0.0, 0.02, -0.05}) {
    for (const double about_y : {0.0, 0.03}) {
      const auto motion = stage(
          {{"tilt", std::vector<double>{about_x, about_y}}, {"rotation", 0.4}, {"pivot", std::vector<double>{3e-3, -2e-3}}});
      for (const double t : {1.0, 2.5, 4.0})
        EXPECT_NEAR((motion->pad_at(t).pose * Eigen::Vector3d(0.0, 0.0, 0.0)).z(), -1e-3, 1e-15);
      // A tip at +x sinks by x sin(tilt about Y); one at +y rises by y sin(tilt about X) cos(tilt
      // about Y).
      const Pose pose = motion->pad_at(1.0).pose;
      EXPECT_NEAR((pose * Eigen::Vector3d(7e-3, 0.0, 0.0)).z(), -1e-3 - 7e-3 * std::sin(about_y), 1e-15);
      EXPECT_NEAR((pose * Eigen::Vector3d(0.0, 7e-3, 0.0)).z(), -1e-3 + 7e-3 * std::sin(about_x) * std::cos(about_y), 1e-15);
    }
  }
}

std::unique_ptr<Motion> rocking_stage(std::uint64_t trial, const Changes& changes) {
  Parameters parameters = defaults_of(stage_motion().about.parameters);
  for (const auto& [name, value] : changes) parameters.set(name, value);
  return stage_motion().create(parameters, {3, trial});
}

const Changes rocking{{"rocking", std::vector<double>{0.01, 0.02}},
                      {"heave", 20e-6},
                      {"rocking_corner", 0.3},
                      {"tilt", std::vector<double>{0.1, -0.2}},
                      {"pivot", std::vector<double>{3e-3, -2e-3}},
                      {"rotation", 0.4}};

// Central differences over 2 us inside a knot. The third derivative of a cubic between knots is at
// most some 1e3/s^3 times 0.02, and h^2/6 times that is below 1e-11.
TEST(Stage, VelocityOfARockingStageIsTheRateOfItsPose) {
  const auto motion = rocking_stage(1, rocking);
  const double h = 1e-6;
  double fastest = 0.0;
  for (double t = 2.504; t < 6.0; t += 0.03) {
    const BodyState before = motion->pad_at(t - h), now = motion->pad_at(t), after = motion->pad_at(t + h);
    EXPECT_NEAR((now.velocity - (after.pose.position - before.pose.position) / (2.0 * h)).norm(), 0.0, 1e-8);
    const Eigen::Matrix3d spin = (after.pose.rotation - before.pose.rotation) / (2.0 * h) * now.pose.rotation.transpose();
    EXPECT_NEAR((now.angular_velocity - Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0))).norm(), 0.0, 1e-8);
    fastest = std::max(fastest, now.angular_velocity.norm() * 0.01);
  }
  EXPECT_LE(fastest, motion->top_speed(0.01));
  EXPECT_EQ(motion->longest_step(), 0.01);
}

// The tilt about X is rocking[0] p_1, the height -1 mm + heave p_3, with p of variance 1. At instants
// 4 s apart, all but (1 + 7.5) exp(-7.5) = 0.5 % is forgotten. Over 200 trials and 3 instants a mean of
// squares has the standard error sqrt(2/600) = 0.058; five are allowed.
TEST(Stage, RockingAndHeaveHaveTheirStandardDeviations) {
  double about_x = 0.0, about_y = 0.0, rises = 0.0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    const auto motion =
        rocking_stage(trial, {{"rocking", std::vector<double>{0.01, 0.02}}, {"heave", 20e-6}, {"rocking_corner", 0.3}});
    for (const double t : {2.0, 6.0, 10.0}) {
      const Pose pose = motion->pad_at(t).pose;
      about_x += std::pow(std::atan2(pose.rotation(2, 1), pose.rotation(2, 2)) / 0.01, 2) / 600.0;
      about_y += std::pow(std::asin(-pose.rotation(2, 0)) / 0.02, 2) / 600.0;
      rises += std::pow((pose.position.z() + 1e-3) / 20e-6, 2) / 600.0;
    }
  }
  for (const double variance : {about_x, about_y, rises}) EXPECT_NEAR(variance, 1.0, 5.0 * 0.058);
}

TEST(Stage, DrawsRandomNumbersOnlyIfItRocks) {
  Parameters parameters = defaults_of(stage_motion().about.parameters);
  EXPECT_FALSE(stage_motion().is_random(parameters));
  parameters.set("heave", 1e-6);
  EXPECT_TRUE(stage_motion().is_random(parameters));
}

TEST(Stage, SlidesAlongItsDirectionFromTheStart) {
  // s(t) = a (t - 2)^2/2 up to 0.08 s, then 4 mm/s (t - 2 - 0.04).
  const double direction = 0.7;
  const auto motion = stage({{"direction", direction}});
  const Eigen::Vector3d d(std::cos(direction), std::sin(direction), 0.0);
  for (const auto& [t, way, speed] :
       std::vector<std::array<double, 3>>{{1.99, 0.0, 0.0}, {2.04, 0.04e-3, 2e-3}, {2.08, 0.16e-3, 4e-3}, {4.0, 7.84e-3, 4e-3}}) {
    const BodyState pad = motion->pad_at(t);
    EXPECT_NEAR((pad.pose.position - way * d - Eigen::Vector3d(0.0, 0.0, -1e-3)).norm(), 0.0, 1e-15) << "t " << t;
    EXPECT_NEAR((pad.velocity - speed * d).norm(), 0.0, 1e-12) << "t " << t;
    EXPECT_EQ(pad.angular_velocity.norm(), 0.0);
    EXPECT_EQ(pad.pose.rotation, Eigen::Matrix3d::Identity());
  }
  EXPECT_FALSE(motion->turns());
}

TEST(Stage, RestsAtTheEndOfItsTravel) {
  // 6 mm at 4 mm/s and 50 mm/s^2: 6/4 + 4/50 = 1.58 s from the start at 2 s.
  const auto motion = stage({{"travel", 6e-3}});
  EXPECT_NEAR(motion->pad_at(2.79).pose.position.x(), 3e-3, 1e-15);
  EXPECT_NEAR(motion->pad_at(2.79).velocity.x(), 4e-3, 1e-15);
  for (const double t : {3.58, 4.0, 100.0}) {
    EXPECT_NEAR(motion->pad_at(t).pose.position.x(), 6e-3, 1e-15) << t;
    EXPECT_EQ(motion->pad_at(t).velocity.x(), 0.0) << t;
  }
  // Forward, back and forward again, without a pause.
  const auto thrice = stage({{"travel", 6e-3}, {"strokes", std::int64_t{3}}});
  EXPECT_NEAR(thrice->pad_at(3.58).pose.position.x(), 6e-3, 1e-15);
  EXPECT_NEAR(thrice->pad_at(3.58 + 0.79).pose.position.x(), 3e-3, 1e-14);
  EXPECT_NEAR(thrice->pad_at(3.58 + 0.79).velocity.x(), -4e-3, 1e-14);
  EXPECT_NEAR(thrice->pad_at(3.58 + 1.58).pose.position.x(), 0.0, 1e-14);
  EXPECT_NEAR(thrice->pad_at(10.0).pose.position.x(), 6e-3, 1e-14);
  EXPECT_THAT(refusal({{"travel", 6e-3}, {"stop", 1.0}}), refused_at("motion.travel", {"6 mm", "motion.stop", "motion.reverse"}));
  EXPECT_THAT(refusal({{"travel", 6e-3}, {"speed", 0.0}}), refused_at("motion.travel", {"6 mm", "motion.speed", "0"}));
}

TEST(Stage, DoesTheSameHigherUp) {
  const auto motion = stage({}), above = stage({{"clearance", 10e-3}});
  for (const double t : {0.0, 0.2, 1.0, 2.3, 4.0}) {
    EXPECT_NEAR(height(*above, t) - height(*motion, t), 10e-3, 1e-17) << t;
    EXPECT_EQ(above->pad_at(t).velocity, motion->pad_at(t).velocity) << t;
  }
}

TEST(Stage, HasMotorsWhereTheyAreToBeFelt) {
  EXPECT_FALSE(stage()->motors());
  const auto motors = stage({{"vibration", 2.0}, {"lead", std::vector{8e-3, 6e-3, 4e-3}}})->motors();
  ASSERT_TRUE(motors);
  EXPECT_EQ(motors->level, 2.0);
  EXPECT_EQ(motors->lead, Eigen::Vector3d(8e-3, 6e-3, 4e-3));
  EXPECT_EQ(motors->in_contact, 1.6);
}

TEST(Stage, StopsAndReversesOnTime) {
  // Braked 0.5 s after the start: v x 0.5 s in total, at rest after another 0.08 s.
  const auto stopped = stage({{"stop", 0.5}});
  EXPECT_NEAR(stopped->pad_at(2.5).velocity.x(), 4e-3, 1e-15);
  EXPECT_NEAR(stopped->pad_at(2.54).velocity.x(), 2e-3, 1e-14);
  for (const double t : {2.58, 3.0, 9.0}) {
    EXPECT_NEAR(stopped->pad_at(t).pose.position.x(), 2e-3, 1e-15);
    EXPECT_NEAR(stopped->pad_at(t).velocity.x(), 0.0, 1e-14);
  }
  // Reversed at 0.5 s: v t - v^2/(2 a) = 1.84 mm forward by then, +-0.16 mm during the reversal, 0
  // again after another 1.84/4 = 0.46 s.
  const auto reversed = stage({{"reverse", 0.5}});
  EXPECT_NEAR(reversed->pad_at(2.5).pose.position.x(), 1.84e-3, 1e-15);
  EXPECT_NEAR(reversed->pad_at(2.58).pose.position.x(), 2.0e-3, 1e-15);
  EXPECT_NEAR(reversed->pad_at(2.66).velocity.x(), -4e-3, 1e-14);
  EXPECT_NEAR(reversed->pad_at(2.66 + 0.46).pose.position.x(), 0.0, 1e-15);
  // Stopped in the middle of the reversal, where its velocity is exactly zero: 1/16 m/s at 1/4
  // m/s^2 takes 0.25 s.
  const auto both = stage({{"speed", 0.0625}, {"acceleration", 0.25}, {"reverse", 1.0}, {"stop", 1.25}});
  EXPECT_NEAR(both->pad_at(3.25).velocity.x(), 0.0, 1e-15);
  EXPECT_NEAR(both->pad_at(6.0).velocity.x(), 0.0, 1e-15) << "it stays at rest";
}

TEST(Stage, PivotMovesOnAStraightLineWhileThePadTurnsAboutIt) {
  const Eigen::Vector3d pivot(4e-3, -2.5e-3, 0.0), d(std::cos(0.5), std::sin(0.5), 0.0);
  const auto motion = stage({{"rotation", 0.5},
                             {"direction", 0.5},
                             {"pivot", std::vector<double>{pivot.x(), pivot.y()}},
                             {"angular_acceleration", inf},
                             {"acceleration", inf}});
  EXPECT_TRUE(motion->turns());
  for (const double t : {2.0, 2.3, 3.7, 10.0}) {
    const BodyState pad = motion->pad_at(t);
    const double way = 4e-3 * (t - 2.0), angle = 0.5 * (t - 2.0);
    EXPECT_NEAR((pad.pose * pivot - pivot - way * d - Eigen::Vector3d(0.0, 0.0, -1e-3)).norm(), 0.0, 1e-15) << "t " << t;
    EXPECT_NEAR((pad.pose.rotation - Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix()).norm(), 0.0, 1e-14);
    // Velocity of the pivot point: v d, without a share of the turn.
    const Eigen::Vector3d at_pivot = pad.velocity + pad.angular_velocity.cross(pad.pose * pivot - pad.pose.position);
    EXPECT_NEAR((at_pivot - 4e-3 * d).norm(), 0.0, 1e-15);
  }
  // When tilted, the pivot lies in the surface's plane: the pad's own point deviates by at most
  // |pivot| tilt^2/2 and stays at one height.
  const double tilt = 0.03;
  const auto tilted = stage({{"rotation", 0.5},
                             {"pivot", std::vector<double>{pivot.x(), pivot.y()}},
                             {"tilt", std::vector<double>{0.0, tilt}},
                             {"speed", 0.0}});
  for (const double t : {2.3, 5.0}) {
    EXPECT_LE((tilted->pad_at(t).pose * pivot - pivot).head<2>().norm(), 2.0 * pivot.norm() * tilt * tilt / 2.0);
    EXPECT_NEAR((tilted->pad_at(t).pose * pivot).z(), (tilted->pad_at(2.0).pose * pivot).z(), 1e-15);
  }
}

TEST(Stage, VelocitiesAreTheDerivativesOfThePose) {
  // The error of the central difference over +-h is h/2 times the largest acceleration, plus 1e-17
  // m/h of rounding. Accelerations: 50 mm/s^2 sideways and down, lever x (alpha + rate^2) <= 5 mm x
  // (8.8 + 0.3) = 45 mm/s^2 for turning about the pivot; the angle's own is 8.8 rad/s^2.
  const double h = 1e-6, acceleration = 2.0 * 50e-3 + 45e-3, alpha = 8.8;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    RandomStream draw(seed, 0, "stage");
    const auto motion = stage({{"rotation", draw.uniform(-0.5, 0.5)},
                               {"direction", draw.uniform(-pi, pi)},
                               {"speed", draw.uniform(0.0, 16e-3)},
                               {"pivot", std::vector<double>{draw.uniform(-3e-3, 3e-3), draw.uniform(-3e-3, 3e-3)}},
                               {"tilt", std::vector<double>{draw.uniform(-0.05, 0.05), draw.uniform(-0.05, 0.05)}},
                               {"reverse", draw.uniform(0.2, 0.6)},
                               {"stop", draw.uniform(0.7, 1.0)},
                               {"retract", 3.2}});
    for (double t = 0.01; t < 4.0; t += 0.013) {
      const BodyState before = motion->pad_at(t - h), now = motion->pad_at(t), after = motion->pad_at(t + h);
      const Eigen::Vector3d velocity = (after.pose.position - before.pose.position) / (2.0 * h);
      ASSERT_NEAR((velocity - now.velocity).norm(), 0.0, 0.5 * h * acceleration + 1e-10) << "t " << t;
      const Eigen::Matrix3d spin = (after.pose.rotation - before.pose.rotation) / (2.0 * h) * now.pose.rotation.transpose();
      const Eigen::Vector3d rate(spin(2, 1), spin(0, 2), spin(1, 0));
      ASSERT_NEAR((rate - now.angular_velocity).norm(), 0.0, 0.5 * h * alpha + 1e-9) << "t " << t;
      ASSERT_NEAR((now.pose.rotation * now.pose.rotation.transpose() - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-14);
    }
  }
}

TEST(Stage, TopSpeedBoundsEveryPointOfThePad) {
  const double reach = 10e-3;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    RandomStream draw(seed, 1, "stage top speed");
    const auto motion = stage({{"rotation", draw.uniform(-1.0, 1.0)},
                               {"speed", draw.uniform(0.0, 16e-3)},
                               {"reverse", 0.5},
                               {"pivot", std::vector<double>{draw.uniform(-9e-3, 9e-3), draw.uniform(-9e-3, 9e-3)}},
                               {"retract", 3.0}});
    const double bound = motion->top_speed(reach);
    double fastest = 0.0;
    for (double t = 0.0; t < 4.0; t += 0.01) {
      const BodyState pad = motion->pad_at(t);
      for (int k = 0; k < 16; ++k) {
        const Eigen::Vector3d arm =
            pad.pose.rotation * Eigen::Vector3d(reach * std::cos(k * pi / 8.0), reach * std::sin(k * pi / 8.0), 0.0);
        fastest = std::max(fastest, (pad.velocity + pad.angular_velocity.cross(arm)).norm());
      }
    }
    EXPECT_LE(fastest, bound * (1.0 + 1e-12));
    EXPECT_GE(fastest, bound / 4.0) << "a useful bound: slide, press and turn never add up fully";
  }
}

TEST(Stage, LongestStepTurnsByThreeDegrees) {
  EXPECT_NEAR(stage({{"rotation", -pi}})->longest_step(), 1.0 / 60.0, 1e-15);  // 3 of 180 deg/s
  EXPECT_EQ(stage({{"speed", 0.0}})->longest_step(), inf) << "a press that lasts";
  // Ten strokes of 1 mm at 100 mm/s without ramps: 1 % of a stroke takes 0.1 ms.
  EXPECT_NEAR(stage({{"travel", 1e-3}, {"strokes", std::int64_t{10}}, {"speed", 0.1}, {"acceleration", inf}})->longest_step(),
              1e-4, 1e-15);
}

TEST(Stage, LongestStepLosesOnePercentOfASlideBesideThePress) {
  // Without ramps: pressed at 15 ms, then a pause of 5 ms. The slide of 20 mm at 100 mm/s ends at
  // 220 ms, the lift begins at 300 ms. 1 % of the slide takes 2 ms.
  const Changes fast{{"acceleration", inf}, {"approach_speed", 0.1}, {"speed", 0.1}, {"start", 0.02}};
  const auto step = [&](Changes more) {
    more.insert(more.begin(), fast.begin(), fast.end());
    return stage(more)->longest_step();
  };
  EXPECT_NEAR(step({{"travel", 20e-3}, {"retract", 0.3}}), 5e-3 + 2e-3, 1e-12);
  EXPECT_NEAR(step({{"stop", 0.2}, {"retract", 0.3}}), 5e-3 + 2e-3, 1e-12);
  // A pause of 1 ms before the lift; and a lift during the slide, of which 201 ms until the pad is
  // up count, and 1 % of that without a pause.
  EXPECT_NEAR(step({{"stop", 0.2}, {"retract", 0.221}}), 1e-3 + 2e-3, 1e-12);
  EXPECT_NEAR(step({{"retract", 0.206}}), 0.01 * (0.206 + 0.015 - 0.02), 1e-12);
  // A slide without an end counts for 1 s.
  EXPECT_NEAR(step({}), 5e-3 + 0.01, 1e-12);
  // Turned at 10 deg/s for 0.3 s, 1 % of which takes 3 ms.
  EXPECT_NEAR(step({{"speed", 0.0}, {"rotation", pi / 18.0}, {"angular_acceleration", inf}, {"stop", 0.3}}), 5e-3 + 3e-3, 1e-12);
  // A pad that never touches loses nothing.
  EXPECT_EQ(step({{"clearance", 2e-3}, {"retract", 0.206}}), inf);

  // With a ramp of 50 mm/s^2 to 4 mm/s the slide of 0.4 s is 1.6 mm long, and its first 16 um take
  // sqrt(2 16e-6/0.05) = 25.3 ms. Pressed at 455 ms.
  EXPECT_NEAR(stage({{"stop", 0.4}})->longest_step(), 2.0 - 0.455 + std::sqrt(2.0 * 16e-6 / 0.05), 1e-12);
}

TEST(Stage, LongestStepIsShorterThanATouch) {
  // Pressed at 15 ms and lifted at 20 ms; the tip is 1 mm deep, which takes 10 ms either way.
  EXPECT_NEAR(
      stage({{"acceleration", inf}, {"approach_speed", 0.1}, {"speed", 0.0}, {"start", 0.02}, {"retract", 0.02}})->longest_step(),
      5e-3 + 2.0 * 10e-3, 1e-12);
}

TEST(Stage, TakesAStartThatOnlyRoundingMakesEarly) {
  // (0.5 + 1) mm/4 mm/s + 4/50 s = 0.455 s, of which decimal text is 1e-16 away at most.
  EXPECT_EQ(refusal({{"start", std::nextafter(0.455, 0.0)}}), "accepted");
  // The message names a time that is accepted, in the unit of the one found: 100/7 us more.
  EXPECT_THAT(refusal({{"start", 0.4549}, {"gap", 0.5e-3 + 0.4e-6 / 7.0}}), refused_at("motion.start", {"454.9 ms", "455.1 ms"}));
}

TEST(Stage, RefusesTimesOutOfOrder) {
  EXPECT_THAT(refusal({{"start", 0.45}}), refused_at("motion.start", {"450 ms", "455 ms"}));
  EXPECT_EQ(refusal({{"start", 0.456}}), "accepted");
  EXPECT_THAT(refusal({{"reverse", 0.5}, {"stop", 0.4}}), refused_at("motion.reverse", {"motion.stop", "0.5 s", "0.4 s"}));
  EXPECT_NE(refusal({{"reverse", 0.4}, {"stop", 0.4}}), "accepted");
  EXPECT_EQ(refusal({{"reverse", 0.4}, {"stop", 0.5}}), "accepted");
  EXPECT_EQ(refusal({{"reverse", inf}, {"stop", 0.5}}), "accepted");
  EXPECT_THAT(refusal({{"retract", 0.1}}), refused_at("motion.retract", {"motion.start", "0.1 s", "2 s"}));
  EXPECT_EQ(refusal({{"retract", 2.5}}), "accepted");
}

}  // namespace
}  // namespace slipbench::stage_test
