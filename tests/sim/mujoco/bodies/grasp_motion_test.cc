// A grasp that moves: drops and their times, independence of the step, and detected failures.
#include <algorithm>

#include <fmt/format.h>

#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/grasp_rig.h"

namespace slipbench {
namespace {

constexpr double weight = 0.2 * 9.81;  // N, of the default box

std::string refusal(const std::string& text, const DynamicSimulationOptions& options = {}) {
  return refusal_of([&] {
    GraspRig rig(text, 0, options);
    rig.run();
  });
}

TEST(GraspMotion, DropIsLabelledAtTheTickAtWhichAPadLetsGo) {
  // Held in the air, then opened. The pads detach when the opening has grown by the compression of
  // pads and fingers, that is to the box's width minus the centre pillar's lead over the box's
  // face, which is 0. The fingers' springs follow within 1/omega = 3 ms.
  GraspRig rig("friction: {static: 0.8}\ngrip: {}\nmotion: {kind: lift, settle: 1 s, distance: 50 mm}\nduration: 5 s\n");
  rig.run_to(3.0);
  EXPECT_TRUE(rig->truth().lifted);
  rig.more = -20;
  double off = 0.0, dropped = 0.0;
  while (off == 0.0 || dropped == 0.0) {
    rig.step();
    const GraspTruth& truth = rig->truth();
    ASSERT_LT(truth.time, 4.0);
    if (off == 0.0 && rig->gripper().opening(truth.time) >= 0.06) off = truth.time;
    if (dropped > 0.0) continue;
    const double weaker = std::min(truth.pad_force[0], truth.pad_force[1]);
    EXPECT_EQ(truth.dropped, weaker == 0.0) << truth.time;
    if (truth.dropped) dropped = truth.time;
  }
  EXPECT_NEAR(dropped, off, 4e-3);
  rig.run_to(4.5);
  EXPECT_TRUE(rig->truth().dropped) << "it stays so";
  EXPECT_TRUE(rig->truth().lifted) << "before";
  EXPECT_NEAR(rig->truth().lift_height, 0.05, 1e-3);
  EXPECT_GT(rig->truth().table_force, 0.0) << "it lies on the table";
}

// mu F of both pads is 0.1 N of the box's 2 N: the box does not move.
TEST(GraspMotion, BoxThatStaysOnTheTableIsLeftBehindWhenTheArmHasRisenAndIsNotDropped) {
  GraspRig rig("friction: {static: 0.01}\ngrip: {}\nmotion: {kind: lift, settle: 1 s, distance: 10 mm}\nduration: 2 s\n");
  const double risen = 1.0 + 0.01 / 0.043 + 0.043 / 0.4;
  while (!rig->truth().left_behind && rig->truth().time < 1.9) rig.step();
  EXPECT_GE(rig->truth().time, risen);
  EXPECT_LT(rig->truth().time, risen + 1.001 * rig->time_step(0));
  rig.run();
  EXPECT_TRUE(rig->truth().left_behind);
  EXPECT_FALSE(rig->truth().lifted);
  EXPECT_FALSE(rig->truth().dropped);
  EXPECT_EQ(rig->truth().lift_height, 0.0);
}

// The same with a lift that ends with the trial: only its last tick has the arm at the top.
TEST(GraspMotion, LiftThatEndsWithTheTrialIsJudgedAtItsLastTick) {
  // 1 s + 10 mm / (40 mm/s) + 40/400 s
  GraspRig rig(
      "friction: {static: 0.01}\ngrip: {}\nmotion: {kind: lift, settle: 1 s, distance: 10 mm, speed: 40 mm/s}\nduration: 1.35 s\n");
  rig.run();
  EXPECT_TRUE(rig->truth().left_behind);
}

// The arm rises by 1 mm, fingers and pads take some tenths of that: a hanging box counts as lifted,
// however little.
TEST(GraspMotion, SmallLiftIsALift) {
  GraspRig rig(
      "friction: {static: 0.8}\ngrip: {preset: 8 N}\nmotion: {kind: lift, settle: 1.5 s, distance: 1 mm}\nduration: 3 s\n");
  rig.run();
  EXPECT_EQ(rig->truth().table_force, 0.0);
  EXPECT_TRUE(rig->truth().lifted);
  EXPECT_FALSE(rig->truth().left_behind);
  EXPECT_GT(rig->truth().lift_height, 0.1e-3);
  EXPECT_LT(rig->truth().lift_height, 1.1e-3);
}

// A box held at one of its ends turns in the pads: the arm rises by 20 mm, and the far end of the
// box stays on the table.
TEST(GraspMotion, BoxWithAnEdgeOnTheTableIsNotLifted) {
  GraspRig rig(
      "friction: {static: 0.6}\ngrip: {preset: 5 N}\nbox: {size: [60 mm, 300 mm, 100 mm], mass: 0.3 kg, position: [0 mm, 120 mm]}\n"
      "motion: {kind: lift, settle: 1.5 s, distance: 20 mm}\nduration: 3 s\n");
  rig.run();
  ASSERT_GT(rig->truth().tilt, 0.03) << "it has turned";
  EXPECT_GT(rig->truth().box_height, 3e-3);
  EXPECT_GT(rig->truth().table_force, 0.0);
  EXPECT_FALSE(rig->truth().lifted);
  EXPECT_TRUE(rig->truth().left_behind);
  EXPECT_FALSE(rig->truth().dropped);
}

// The shaking after the lift moves the arm down by twice its height for a moment: the box is put
// down and stands.
TEST(GraspMotion, BoxThatIsPutDownAgainWasLiftedAndIsLost) {
  GraspRig rig(
      "friction: {static: 1.2}\ngrip: {preset: 8 N}\nmotion: {kind: lift, settle: 1.5 s, distance: 10 mm, shake: [0 mm, 0 mm, -12 mm], "
      "shake_frequency: 1 Hz, shake_cycles: 1}\nduration: 3.5 s\n");
  rig.run_to(1.9);
  EXPECT_TRUE(rig->truth().lifted);
  EXPECT_FALSE(rig->truth().dropped);
  EXPECT_NEAR(rig->truth().lift_height, 10e-3, 1e-3);
  rig.run();
  EXPECT_TRUE(rig->truth().lifted);
  EXPECT_TRUE(rig->truth().dropped);
  EXPECT_FALSE(rig->truth().left_behind);
}

TEST(GraspMotion, SlipIsCountedFromTheLiftOn) {
  GraspRig rig("grip: {}\nmotion: {kind: lift, settle: 1 s}\nduration: 3.5 s\n");
  rig.run_to(0.99);
  EXPECT_EQ(rig->truth().slip, Eigen::Vector3d::Zero());
  const Eigen::Vector3d before = rig.box_in_arm();
  rig.run_to(2.9);
  EXPECT_LT((rig->truth().slip - (rig.box_in_arm() - before)).norm(), 1e-6);  // with 10 ms of rest in between
  EXPECT_LT(rig->truth().slip.z(), 0.0);
}

TEST(GraspMotion, CarriesTiltsAndShakes) {
  GraspRig rig(
      "friction: {static: 1.2}\ngrip: {preset: 12 N}\nmotion: {kind: lift, settle: 2 s, distance: 50 mm, speed: 100 mm/s, sideways: [30 mm, -20 mm], tilt: [0 deg, 30 deg], shake: [5 mm, 0 mm, 10 mm], shake_frequency: 4 Hz, shake_cycles: 4}\n"
      "duration: 8 s\n");
  rig.run();
  EXPECT_FALSE(rig->truth().dropped);
  EXPECT_TRUE(rig->rotating());
  EXPECT_LT((rig.body("arm").pose.position - Eigen::Vector3d(0.03, -0.02, 0.05)).norm(), 1e-12);
  EXPECT_LT((rig.pads_on_box() - Eigen::Vector3d(0.0, 0.0, weight)).norm(), 1e-3 * weight);
  EXPECT_LT(rig->truth().slip.norm(), 2e-3);
  // Turned about Y by 30 degrees with the arm: its own X axis points down by half its length,
  // except for the springs' compliance.
  EXPECT_NEAR(rig.body("box").pose.rotation(2, 0), -0.5, 0.02);
}

TEST(GraspMotion, TrialsDifferAndRunThrough) {
  for (const std::uint64_t trial : {0U, 1U, 2U}) {
    GraspRig rig("surface: {material: rubber}\ngrip: {}\nscatter: {}\nmotion: {kind: lift, settle: 1.5 s}\nduration: 4 s\n",
                 trial);
    rig.run();
    EXPECT_FALSE(rig->truth().dropped) << trial;
    EXPECT_NEAR(rig->truth().box_height, 0.1, 2e-3) << trial;
  }
}

// Data that a picture of the trial needs in addition to the poses.
TEST(GraspMotion, BoxAndSiliconePadSayTheirSize) {
  GraspRig rig("surface: {material: rubber}\ngrip: {}\nscatter: {}\nmotion: {kind: lift}\n");
  for (const NamedBody& body : rig->bodies()) {
    if (body.name == "box") {
      // 60 mm plus up to a count, as drawn.
      EXPECT_EQ(body.size, (std::vector<double>{rig->grasp().box_size.x(), 0.06, 0.1}));
    } else if (body.name == "second_pad") {
      EXPECT_EQ(body.size, (std::vector<double>{0.022, 0.0375, 0.0}));
    } else {
      EXPECT_TRUE(body.size.empty()) << body.name;
    }
  }
}

TEST(GraspMotion, StepThatIsTooLongIsRefusedBeforeTheFirst) {
  // 0.75/omega and 2/omega, with omega at most that of the 400 N/mm pad between a finger of 80 g
  // and half a box of 0.2 kg, held at its rim: 0.5 ms is above the first and below the second.
  const std::string message = refusal("grip: {}\ntime_step: 0.5 ms\nfield_solver: explicit\n");
  EXPECT_NE(message.find("time_step: 0.5 ms is too long for explicit springs of the pads"), std::string::npos) << message;
  const std::string longer = refusal("grip: {}\ntime_step: 1 ms\n");
  EXPECT_NE(longer.find("time_step: 1 ms is too long for implicit springs of the pads"), std::string::npos) << longer;
  // Stiffer fingers also count: 8 kN/mm and 80 g, 10,000 rad/s, 75 us or 200 us.
  for (const char* rest : {"time_step: 0.1 ms\nfield_solver: explicit\n", "time_step: 0.25 ms\n"}) {
    const std::string stiff = refusal(std::string("grip: {stiffness: [8000 N/mm, 15 N/mm, 15 N/mm]}\n") + rest);
    EXPECT_NE(stiff.find("too long"), std::string::npos) << stiff;
  }
}

TEST(GraspMotion, UnstableRunIsCaught) {
  DynamicSimulationOptions options;
  options.refuse_long_steps = false;
  for (const char* step : {"0.5 ms", "1 ms"}) {
    const std::string message = refusal(fmt::format("grip: {{}}\nfield_solver: explicit\ntime_step: {}\n", step), options);
    EXPECT_NE(message.find("the simulation has diverged"), std::string::npos) << step << ": " << message;
  }
}

TEST(GraspMotion, PadThatPressesHarderThanItsFingerCanIsCaught) {
  // The same without the checks of energy and weight, and with a step so far beyond the limit that
  // rounding does not decide if the growing vibration reaches the pads.
  DynamicSimulationOptions options;
  options.refuse_long_steps = false;
  options.limits.energy_share = options.limits.ejection_factor = options.limits.weight_share = 1e300;
  const std::string message = refusal("grip: {}\nfield_solver: explicit\ntime_step: 1 ms\n", options);
  EXPECT_NE(message.find("pad's normal force is"), std::string::npos) << message;
}

TEST(GraspMotion, RefusesASensorThatIsNamedAsTheOtherPad) {
  Scene scene = parsed("slipbench: 1\nsensors: {second_pad: {type: papillarray}}\ngrip: {}\n");
  register_plugin_once();
  const auto sensor = make_sensor(scene.sensors.front(), 0, 0);
  const PadLayout* pad = &sensor->layout();
  const double rate = sensor->rate();
  EXPECT_THROW(GraspSimulation(scene, {&pad, 1}, {&rate, 1}, 0), SceneValueError);
}

}  // namespace
}  // namespace slipbench
