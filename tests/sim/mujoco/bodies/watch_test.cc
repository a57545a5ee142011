// The rules that a run must obey: each on numbers made for it, and all of them on runs that are right and runs that are not.

#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"

namespace slipbench {
namespace {

// The first complaint over 0.5 s at 1 ms of a body of 100 g whose forces are `share` of its weight; "" for none.
std::string weighed(double share, const Eigen::Vector3d& momentum_rate = Eigen::Vector3d::Zero(), double pad_speed = 0.0) {
  WeightRule rule{WatchLimits{}};
  for (int tick = 0; tick < 500; ++tick) {
    WatchedBody body{.mass = 0.1,
                     .weight = {0.0, 0.0, -weight_of_100_g},
                     .momentum = 1e-3 * tick * momentum_rate,
                     .force = {0.0, 0.0, share * weight_of_100_g}};
    WatchedDashpot dashpot{64.0, 0.01, {}};  // 1 ms * 64 kN/m
    dashpot.pad.position.z() = 1e-3 * tick * pad_speed;
    body.dashpots = {dashpot};
    if (const auto wrong = rule.check(body, 1e-3)) return *wrong;
  }
  return "";
}

TEST(Watch, WeightMustBeCarriedToATenthOfAPercent) {
  EXPECT_EQ(weighed(1.0), "");
  EXPECT_EQ(weighed(1.0009), "");
  EXPECT_EQ(weighed(0.9991), "");
  EXPECT_THAT(weighed(1.0011), HasSubstr("the forces on it miss its weight of 0.981 N by 0.00108 N"));
  EXPECT_THAT(weighed(0.9989), HasSubstr("miss its weight"));
}

TEST(Watch, MomentumThatChangesIsNoMissingWeight) {
  EXPECT_THAT(weighed(0.98), HasSubstr("miss its weight"));
  EXPECT_EQ(weighed(0.98, {0.0, 0.0, -0.02 * weight_of_100_g}), "") << "it falls as fast as the missing 2 % say";
}

// 64 N s/m at 1 mm/s are 64 mN, 6.5 % of the weight: not at rest, and the dashpots may well carry what the labels do not say.
TEST(Watch, BodyThatMovesInItsPadsIsNotAtRest) { EXPECT_EQ(weighed(0.98, Eigen::Vector3d::Zero(), 1e-3), ""); }

std::string energy_of(double gain_per_tick, double supply_per_tick) {
  EnergyRule rule(WatchLimits{}, true);
  WatchedEnergy tick;
  tick.kinetic = 1e-3;
  for (int k = 0; k < 500; ++k) {
    tick.field_work = gain_per_tick;
    tick.supply = supply_per_tick;
    if (const auto wrong = rule.check(tick, 1e-3)) return *wrong;
  }
  return "";
}

// 1 mJ at hand, and windows of 0.1 s: 0.6 mJ may come and go, that is 6 uJ a step.
TEST(Watch, PadsMayNotGiveMoreThanTheyTook) {
  EXPECT_EQ(energy_of(-1e-3, 0.0), "") << "losing is always right";
  EXPECT_EQ(energy_of(5.9e-6, 0.0), "");
  EXPECT_THAT(energy_of(6.2e-6, 0.0), HasSubstr("the pads have given"));
  EXPECT_EQ(energy_of(6.2e-6, 1e-6), "") << "0.6 of the 1 mJ and of the 0.1 mJ that came in";
}

TEST(Watch, NoBodyHasMoreThanAllHad) {
  EnergyRule rule(WatchLimits{}, true);
  WatchedEnergy tick;
  tick.kinetic = 1e-3;
  rule.check(tick, 1e-3);
  EXPECT_FALSE(rule.check_body(1.59e-3));
  ASSERT_TRUE(rule.check_body(1.61e-3));
  EXPECT_THAT(*rule.check_body(1.61e-3), HasSubstr("it was thrown out"));
  tick.supply = 1e-3;
  rule.check(tick, 1e-3);
  EXPECT_FALSE(rule.check_body(3.19e-3));
  EXPECT_TRUE(rule.check_body(3.21e-3));
}

// What a run of a scene ends with; "accepted" when it comes to its end.
std::string outcome(const std::string& scene, const std::string& model, const DynamicSimulationOptions& options = {}) {
  const ModelFolder folder;
  folder.write("fingers.xml", model);
  folder.write("block.xml", model);
  folder.write("pad.xml", model);
  DynamicRig rig(scene, folder.file("scene.yaml"), options);
  return refusal_of([&] { rig.run(); });
}

// A pad that looks up, under a box that falls on it askew at 0.5 m/s.
const char* const lying_pad =
    "<worldbody><body name='pad'><geom type='box' pos='0 0 -0.01' size='0.012 0.012 0.005'/><site name='up' zaxis='0 0 -1'/></body></worldbody></mujoco>";
std::string falling_box(const std::string& mass, const std::string& damping) {
  return "duration: 0.5 s\nmodel: pad.xml\nbodies: {box: {shape: box, size: [40 mm, 40 mm, 20 mm], mass: " + mass +
         ", position: [1 mm, 2 mm, 10.5 mm], velocity: [0.1 m/s, 0 m/s, -0.5 m/s], rotation: [1 deg, 2 deg, 3 deg]}}\n"
         "sensors: {up: {type: papillarray, site: up, touches: [box], damping: " +
         damping + "}}\n";
}

class RightRun : public ::testing::TestWithParam<const char*> {};

TEST_P(RightRun, ComesToItsEnd) {
  const std::string integrator = "integrator='" + std::string(GetParam()) + "'";
  const std::string grips =
      "duration: 1 s\ncontrols: {left: [[0.3 s, 4 N], [0.8 s, 0.5 N]], right: [[0.3 s, 4 N], [0.8 s, 0.5 N]]}\n";
  EXPECT_EQ(outcome(held_box(grips), two_fingers(integrator)), "accepted") << "held, and let go";
  // 20 N of push at 50 Hz in triangles: the box of 0.2 kg with the fingers slips to and fro.
  std::string shake = "duration: 0.5 s\ncontrols: {left: 6 N, right: [[0.2 s, 6 N]";
  for (int k = 1; k <= 30; ++k) shake += ", [" + std::to_string(0.2 + 0.01 * k) + " s, " + (k % 2 == 1 ? "1 N]" : "11 N]");
  EXPECT_EQ(outcome(held_box(shake + "]}\n"), two_fingers(integrator)), "accepted") << "shaken";
  for (const std::string mass : {"5 g", "100 g", "5 kg"}) {
    for (const std::string damping : {"0 ms", "1 ms"}) {
      EXPECT_EQ(outcome(falling_box(mass, damping), "<mujoco><option " + integrator + "/>" + lying_pad), "accepted")
          << mass << ", " << damping;
    }
  }
  EXPECT_EQ(outcome(block_on_table("duration: 0.8 s\nfriction: {static: 0.5, kinetic: 0.4}\n"
                                   "controls: {push: [[0.1 s, 0 N], [0.11 s, 50 N], [0.4 s, 50 N], [0.41 s, -50 N]]}\n"),
                    guided_block(integrator)),
            "accepted")
      << "fast";
}

INSTANTIATE_TEST_SUITE_P(Integrators, RightRun, ::testing::Values("Euler", "implicit", "implicitfast", "discrete", "RK4"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Watch, StageRunsAreRight) {
  for (const std::string mass : {"5 g", "100 g", "5 kg"}) {
    for (const std::string motion :
         {"speed: 100 mm/s", "speed: 8 mm/s, approach_speed: 0.5 m/s, acceleration: inf",
          "speed: 8 mm/s, acceleration: inf, reverse: 0.1 s", "speed: 8 mm/s, rotation: 90 deg/s, pivot: [20 mm, 0 mm]",
          "speed: 8 mm/s, retract: 0.8 s"}) {
      std::string scene = pressed_box("duration: 1.2 s\nmotion: {compression: 0.8 mm, start: 0.6 s, " + motion + "}\n");
      scene.replace(scene.find("100 g"), 5, mass);
      EXPECT_EQ(outcome(scene, ""), "accepted") << mass << ", " << motion;
    }
  }
}

// The refusal of long steps switched off. The pads' 64 kN/m on 5 g at 1 ms: h omega = 5 > 2, so every step multiplies the energy.
TEST(Watch, StepBeyondTheLimitIsFoundOut) {
  DynamicSimulationOptions let;
  let.refuse_long_steps = false;
  std::string scene = held_box("duration: 1 s\ntime_step: 1 ms\ncontrols: {left: 4 N, right: 4 N}\n");
  scene.replace(scene.find("100 g"), 5, "5 g");
  EXPECT_THAT(outcome(scene, two_fingers("integrator='implicitfast'"), let), HasSubstr("the run has gone wrong at "));
  let.limits.energy_share = 1e300;
  EXPECT_THAT(outcome(scene, two_fingers("integrator='implicitfast'"), let), HasSubstr("body 'box' has"))
      << "where the pads are not watched, the box is seen to be thrown out";
}

// The same body in MuJoCo's own contact: it begins 9 mm deep in the table, and the contact throws it out.
TEST(Watch, ContactThatThrowsABodyOutIsFoundOut) {
  const std::string scene =
      "duration: 0.5 s\nbodies:\n  table: {shape: plane}\n  box: {shape: box, size: [20 mm, 20 mm, 20 mm], position: [0, 0, 1 mm]}\n"
      "sensors: {pad: {type: papillarray, touches: [box]}}\nmotion: {gap: 90 mm, compression: 0.1 mm, start: 40 s}\n";
  EXPECT_THAT(outcome(scene, ""), HasSubstr("it was thrown out"));
}

TEST(Watch, WarningOfMujocoEndsTheRunWithItsTextTimeAndBody) {
  // 1e9 at a gear of 1000 accelerate 1 kg beyond what MuJoCo takes for a number, 1e10.
  std::string model = guided_block("");
  model.replace(model.find("joint='travel'/></actuator>"), 14, "joint='travel' gear='1000'");
  const std::string text =
      outcome(block_on_table("duration: 0.1 s\ncontrols: {push: [[0.05 s, 0 N], [0.051 s, 1e9 N]]}\n"), model);
  EXPECT_THAT(text, HasSubstr("MuJoCo warns: "));
  EXPECT_THAT(text, HasSubstr("at 0.05"));
  EXPECT_THAT(text, HasSubstr("body 'block'"));
}

}  // namespace
}  // namespace slipbench
