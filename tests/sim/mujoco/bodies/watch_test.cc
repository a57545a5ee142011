// The checks of a run: each on artificial numbers, and all of them on correct and faulty runs.

#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"
#include "tests/sim/mujoco/bodies/dynamic_scenes.h"

namespace slipbench {
namespace {

// Returns the first error over 0.5 s at 1 ms for a body of 100 g with the acceleration [m/s2], on
// which `share` of its weight acts upwards in addition to the weight; "" for none. `swing`:
// alternation of the predicted force from tick to tick [N].
std::string weighed(double share, const Eigen::Vector3d& acceleration = Eigen::Vector3d::Zero(), double swing = 0.0) {
  WeightRule rule{WatchLimits{}};
  for (int tick = 0; tick < 500; ++tick) {
    const WatchedBody body{.weight = weight_of_100_g,
                           .force = {0.0, 0.0, (share - 1.0) * weight_of_100_g},
                           .predicted = {tick % 2 == 0 ? swing : 0.0, 0.0, 0.0},
                           .mass_times_acceleration = 0.1 * acceleration};
    if (const auto wrong = rule.check(body, 1e-3)) return *wrong;
  }
  return "";
}

TEST(Watch, ForcesMustGiveTheAccelerationToATenthOfAPercentOfTheWeight) {
  EXPECT_EQ(weighed(1.0), "");
  EXPECT_EQ(weighed(1.0009), "");
  EXPECT_EQ(weighed(0.9991), "");
  EXPECT_THAT(weighed(1.0011), mentions({"0.00108 N", "0.1 s", "0.001", "0.981 N"}));
  EXPECT_THAT(weighed(0.9989), HasSubstr("differ from its mass times its acceleration"));
  // 2 % of the weight are missing; the body falls accordingly, or not.
  EXPECT_EQ(weighed(0.98, {0.0, 0.0, -0.02 * 9.81}), "");
  EXPECT_THAT(weighed(0.98), HasSubstr("by 0.0196 N"));
  EXPECT_THAT(weighed(0.98, {0.0, 0.0, -0.018 * 9.81}), HasSubstr("by 0.00196 N"));
  EXPECT_THAT(weighed(1.0, {0.02, 0.0, 0.0}), HasSubstr("by 0.002 N")) << "sideways";
}

// A force that changes by s in every step is known to s; a constant one is known exactly.
TEST(Watch, ForceBetweenTwoTicksIsKnownToItsChange) {
  EXPECT_EQ(weighed(0.98, Eigen::Vector3d::Zero(), 0.02), "");
  EXPECT_THAT(weighed(0.98, Eigen::Vector3d::Zero(), 0.018), HasSubstr("by 0.0196 N")) << "0.018 + 0.00098 N are less";
}

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

// 1 mJ available, and windows of 0.1 s: 0.6 mJ may come and go, 6 uJ per step.
TEST(Watch, PadsMayNotGiveMoreThanTheyTook) {
  EXPECT_EQ(energy_of(-1e-3, 0.0), "") << "losing is always right";
  EXPECT_EQ(energy_of(5.9e-6, 0.0), "");
  EXPECT_THAT(energy_of(6.2e-6, 0.0), HasSubstr("the pads have delivered"));
  EXPECT_EQ(energy_of(6.2e-6, 1e-6), "") << "0.6 of the 1 mJ and of the 0.1 mJ that came in";
}

TEST(Watch, NoBodyHasMoreThanAllHad) {
  EnergyRule rule(WatchLimits{}, true);
  WatchedEnergy tick;
  tick.kinetic = 1e-3;
  rule.check(tick, 1e-3);
  EXPECT_FALSE(rule.check_body(1.59e-3));
  ASSERT_TRUE(rule.check_body(1.61e-3));
  EXPECT_THAT(*rule.check_body(1.61e-3), HasSubstr("the contact has thrown it out"));
  tick.supply = 1e-3;
  rule.check(tick, 1e-3);
  EXPECT_FALSE(rule.check_body(3.19e-3));
  EXPECT_TRUE(rule.check_body(3.21e-3));
}

// Returns the error that ends a run of the scene, or "accepted".
std::string outcome(const std::string& scene, const std::string& model, const DynamicSimulationOptions& options = {}) {
  const ModelFolder folder;
  folder.write("fingers.xml", model);
  folder.write("block.xml", model);
  folder.write("pad.xml", model);
  DynamicRig rig(scene, folder.file("scene.yaml"), options);
  return refusal_of([&] { rig.run(); });
}

// A gripper at the end of an arm carries a bar through `turns`, points in time and angle of the
// arm.
std::string carried_bar(const std::string& mass, const std::string& turns, const std::string& more = "") {
  return "duration: 1.2 s\nmodel: fingers.xml\nfriction: {static: 0.8, kinetic: 0.8}\n"
         "bodies: {bar: {shape: box, size: [20 mm, 20 mm, 80 mm], mass: " +
         mass +
         ", centre_of_mass: [1 mm, 0 mm, 4 mm], position: [300 mm, 0 mm, 100 mm]}}\n"
         "controls: {left: 6 N, right: 6 N, turn: " +
         turns +
         "}\n"
         "sensors:\n"
         "  left: {type: papillarray, site: left_pad, touches: [bar]}\n"
         "  right: {type: papillarray, site: right_pad, touches: [bar]}\n" +
         more;
}
std::string turning_arm(const std::string& options) {
  return "<mujoco><option " + options +
         "/><worldbody><body name='arm' pos='0 0 0.1'><joint name='turn' type='hinge' axis='0 0 1' damping='2' armature='0.02'/><geom type='box' pos='0.15 0 0.06' size='0.15 0.01 0.01' mass='0.5' contype='0' conaffinity='0'/>"
         "<body pos='0.3 -0.00973 0'><joint name='left' type='slide' axis='0 1 0' damping='5'/><geom type='box' pos='0 -0.01 0' size='0.012 0.005 0.012' mass='0.05'/><site name='left_pad' zaxis='0 -1 0'/></body>"
         "<body pos='0.3 0.00973 0'><joint name='right' type='slide' axis='0 -1 0' damping='5'/><geom type='box' pos='0 0.01 0' size='0.012 0.005 0.012' mass='0.05'/><site name='right_pad' zaxis='0 1 0'/></body>"
         "</body></worldbody><actuator><motor name='left' joint='left'/><motor name='right' joint='right'/><position name='turn' joint='turn' kp='200' kv='20'/></actuator></mujoco>";
}
const char* const quarter_turn_to_and_fro = "[[0.3 s, 0 deg], [0.7 s, 90 deg], [1.1 s, 0 deg]]";

// A pad that faces up, under a box that falls on it askew at 0.5 m/s.
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
  // 1 kg at 0.5 m/s is stopped within 2 mm by nine pillars of 7.1 kN/m, sqrt(m/(9 k_n)) v; the
  // pillars are 4.2 mm high.
  for (const std::string mass : {"5 g", "100 g", "1 kg"}) {
    for (const std::string damping : {"0 ms", "1 ms"}) {
      EXPECT_EQ(outcome(falling_box(mass, damping), "<mujoco><option " + integrator + "/>" + lying_pad), "accepted")
          << mass << ", " << damping;
    }
  }
  // 225 deg/s at 0.3 m: 1.2 m/s, and 4.6 m/s2 towards the axis.
  for (const std::string mass : {"20 g", "63 g", "200 g"}) {
    for (const std::string step : {"auto", "0.05 ms"}) {
      EXPECT_EQ(outcome(carried_bar(mass, quarter_turn_to_and_fro, "time_step: " + step + "\n"), turning_arm(integrator)),
                "accepted")
          << "carried, " << mass << ", " << step;
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

// A box that tumbles at 30 rad/s, with its mass off centre: the frame's origin circles the centre
// of mass.
TEST_P(RightRun, OfAnOffCentreBodyThatTumblesComesToItsEnd) {
  const ModelFolder folder;
  folder.write("pad.xml", "<mujoco><option integrator='" + std::string(GetParam()) + "'/>" + lying_pad);
  DynamicRig rig(
      "duration: 0.5 s\nmodel: pad.xml\nbodies: {box: {shape: box, size: [40 mm, 40 mm, 20 mm], mass: 100 g, centre_of_mass: [12 mm, 5 mm, 3 mm], "
      "position: [0 mm, 0 mm, 2 m]}}\nsensors: {up: {type: papillarray, site: up, touches: [box]}}\n",
      folder.file("scene.yaml"));
  const mjModel* m = rig->model();
  const double spin[3] = {20.0, 15.0, 17.0};  // rad/s
  mju_copy3(rig->data()->qvel + m->body_dofadr[mj_name2id(m, mjOBJ_BODY, "box")] + 3, spin);
  EXPECT_EQ(refusal_of([&] { rig.run(); }), "accepted");
}

// A force of 0.5 % of the weight, unknown to the program, pulls on the carried bar along each axis,
// while the arm is at rest, accelerates and turns.
struct Stepped {
  const char* name;
  const char* options;  // of the model
  const char* scene;    // lines
};

class PlantedForce : public ::testing::TestWithParam<Stepped> {};

TEST_P(PlantedForce, IsFoundWithinTwoWindows) {
  const ModelFolder folder;
  folder.write("fingers.xml", turning_arm(GetParam().options));
  const double weight = 0.063 * 9.81;
  for (const double from : {0.1, 0.35, 0.5, 0.65}) {
    for (int axis = 0; axis < 3; ++axis) {
      DynamicRig rig(carried_bar("63 g", quarter_turn_to_and_fro, GetParam().scene), folder.file("scene.yaml"));
      const int bar = mj_name2id(rig->model(), mjOBJ_BODY, "bar");
      rig.run_to(from);
      rig->data()->xfrc_applied[6 * bar + axis] = 0.005 * weight;
      EXPECT_THAT(refusal_of([&] { rig.run_to(from + 0.201); }), mentions({"bar", "forces"})) << from << " s, axis " << axis;
    }
  }
}

TEST_P(PlantedForce, RunWithoutOneIsRight) {
  EXPECT_EQ(outcome(carried_bar("63 g", quarter_turn_to_and_fro, GetParam().scene), turning_arm(GetParam().options)), "accepted");
}

INSTANTIATE_TEST_SUITE_P(Integrators, PlantedForce,
                         ::testing::Values(Stepped{"Euler", "integrator='Euler'", ""},
                                           Stepped{"implicit", "integrator='implicit'", ""},
                                           Stepped{"implicitfast", "integrator='implicitfast'", ""},
                                           Stepped{"discrete", "integrator='discrete'", ""},
                                           Stepped{"RK4", "integrator='RK4'", ""},
                                           Stepped{"implicit_pads", "", "field_solver: implicit\ntime_step: 1 ms\n"}),
                         [](const auto& info) { return std::string(info.param.name); });

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

// Without the refusal of long steps. The pads' 64 kN/m on 5 g at 1 ms: h omega = 5 > 2, so every
// step multiplies the energy.
TEST(Watch, StepBeyondTheLimitIsFoundOut) {
  DynamicSimulationOptions let;
  let.refuse_long_steps = false;
  std::string scene = held_box("duration: 1 s\ntime_step: 1 ms\ncontrols: {left: 4 N, right: 4 N}\n");
  scene.replace(scene.find("100 g"), 5, "5 g");
  EXPECT_THAT(outcome(scene, two_fingers("integrator='implicitfast'"), let), mentions({"diverged"}));
  let.limits.energy_share = 1e300;
  EXPECT_THAT(outcome(scene, two_fingers("integrator='implicitfast'"), let), mentions({"body", "box"}))
      << "where the pads are not watched, the box is seen to be thrown out";
}

// The same body in MuJoCo's own contact: it begins 9 mm deep in the table, and the contact throws
// it out.
TEST(Watch, ContactThatThrowsABodyOutIsFoundOut) {
  const std::string scene =
      "duration: 0.5 s\nbodies:\n  table: {shape: plane}\n  box: {shape: box, size: [20 mm, 20 mm, 20 mm], position: [0, 0, 1 mm]}\n"
      "sensors: {pad: {type: papillarray, touches: [box]}}\nmotion: {gap: 90 mm, compression: 0.1 mm, start: 40 s}\n";
  EXPECT_THAT(outcome(scene, ""), mentions({"thrown it out"}));
}

TEST(Watch, WarningOfMujocoEndsTheRunWithItsTextTimeAndBody) {
  // 1e9 at a gear of 1000 accelerate 1 kg beyond MuJoCo's largest valid number, 1e10.
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
