// A held box against closed forms: weight, friction limit, stiffness, creep.
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/sim/mujoco/bodies/grasp_rig.h"

namespace slipbench::grasp_statics_test {
namespace {

constexpr double gravity = 9.81;                       // m/s2
constexpr double weight = 0.2 * gravity;               // N, of the default box
constexpr double count = 0.374e-3;                     // m
const std::string firm = "friction: {static: 0.8}\n";  // far from slipping

TEST(GraspStatics, StartsOpenAndAtRestOnAWholeCount) {
  GraspRig rig("grip: {}\n");
  rig.step();
  const GraspTruth& truth = rig->truth();
  EXPECT_EQ(truth.time, 0.0);
  EXPECT_EQ(truth.grip_force, 0.0);
  EXPECT_FALSE(truth.dropped);
  // 60 mm and 1 mm on either side: 62 mm are 165.8 counts, so 166.
  EXPECT_NEAR(rig->gripper().opening(0.0), 166 * count, 1e-12);
  const double apart = (rig.body("second_pad").pose.position - rig.body("pad").pose.position).x();
  EXPECT_NEAR(apart, 166 * count, 1e-12);
  // Pad frames: Z from the box into the pad, Y up, on either side.
  EXPECT_LT((rig.body("pad").pose.rotation.col(2) - Eigen::Vector3d(-1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((rig.body("second_pad").pose.rotation.col(2) - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((rig.body("pad").pose.rotation.col(1) - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(GraspStatics, TableCarriesTheBoxAndThenThePadsDo) {
  GraspRig rig(firm + "grip: {}\nmotion: {kind: lift, settle: 1 s}\nduration: 3.5 s\n");
  rig.run_to(0.3);
  EXPECT_NEAR(rig->truth().table_force, weight, 1e-3 * weight);
  EXPECT_EQ(rig->truth().grip_force, 0.0);
  rig.run_to(2.5);
  EXPECT_EQ(rig->truth().table_force, 0.0);
  const Eigen::Vector3d on_box = rig.pads_on_box();
  EXPECT_NEAR(on_box.z(), weight, 1e-3 * weight);
  EXPECT_NEAR(on_box.x(), 0.0, 1e-3 * weight);
  EXPECT_NEAR(on_box.y(), 0.0, 1e-3 * weight);
  // Objects within a millimetre of the arm have risen with it: 43 mm/s for 1.5 s minus half a ramp
  // of 0.1075 s.
  EXPECT_NEAR(rig->truth().box_height, 0.043 * (1.5 - 0.5 * 0.1075), 1e-3);
  EXPECT_FALSE(rig->truth().dropped);
}

TEST(GraspStatics, LiftingAddsMassTimesAcceleration) {
  // 2 m/s^2 for 0.4 s, long enough for the fingers' springs to settle (22 ms per cycle, 30 % of
  // critical damping).
  GraspRig rig(
      firm + "grip: {preset: 8 N}\nmotion: {kind: lift, settle: 1.5 s, speed: 800 mm/s, acceleration: 2 m/s2, distance: 1 m}\n");
  rig.run_to(1.88);
  EXPECT_NEAR(rig.pads_on_box().z(), 0.2 * (gravity + 2.0), 1e-3 * weight);
}

TEST(GraspStatics, ForceOfACountIsThatOfAllSpringsInSeries) {
  // Nine pillars of one height with 7.1 N/mm, a pad of 400 N/mm and two fingers of 8 N/mm, without
  // pitching: 3.729 N/mm.
  GraspRig rig(firm + "grip: {pivot: 0 mm}\nmotion: {kind: lift, settle: 1.5 s, distance: 20 mm}\nduration: 5 s\n", 0, {},
               ", edge_drop: 0 mm, corner_drop: 0 mm");
  constexpr double series = 1.0 / (1.0 / (9.0 * 7100.0) + 1.0 / 400e3 + 2.0 / 8000.0);
  rig.run_to(2.6);
  const double before = rig->truth().grip_force;
  const double opening = rig->gripper().opening(2.6);
  // The force comes from the closing since the pads touched the box.
  EXPECT_NEAR(before, series * (0.06 - opening), 1e-2 * before);
  rig.more = 3;
  rig.run_to(4.0);
  EXPECT_NEAR(rig->gripper().opening(4.0), opening - 3.0 * count, 1e-9);
  EXPECT_NEAR(rig->truth().grip_force - before, series * 3.0 * count, 1e-3 * series * 3.0 * count);
}

// A box in two equal pads, lifted so gently that it weighs only 1e-4 more, with the friction that
// makes the grip force `ratio` times m g/(2 mu).
GraspRig held_at(double ratio, double grip_force, const std::string& more = "") {
  return GraspRig(
      fmt::format("friction: {{static: {}}}\ngrip: {{second_pad: same}}\n"
                  "motion: {{kind: lift, settle: 1 s, speed: 2 mm/s, acceleration: 1 mm/s2, distance: 5 mm}}\nduration: 8 s\n{}",
                  ratio * weight / (2.0 * grip_force), more));
}

TEST(GraspStatics, HoldsAboveTheIdealForceAndDropsBelow) {
  // The grip force depends on the geometry alone, so that of a firmly held box applies to the
  // others.
  GraspRig firm_box = held_at(2.0, 4.5);
  firm_box.run_to(5.0);
  const double force = firm_box->truth().grip_force;
  EXPECT_NEAR(firm_box->ideal_force(), 4.5 / 2.0, 1e-9);

  GraspRig holds = held_at(1.001, force);
  holds.run();
  EXPECT_NEAR(holds->truth().grip_force, force, 2e-4 * force);
  EXPECT_FALSE(holds->truth().dropped);
  EXPECT_LT(holds->truth().slip.norm(), 0.5e-3);

  // 0.001 g for some 5 s: 0.5 x 9.81e-3 x 5^2 = 0.12 m, more than the 37 mm of the pads below the
  // box's contact.
  GraspRig drops = held_at(0.999, force);
  drops.run();
  EXPECT_TRUE(drops->truth().dropped || drops->truth().left_behind);
}

// Across a level grain mu is half of that along it, so the box needs twice the force.
TEST(GraspStatics, IdealForceIsThatAgainstTheWeight) {
  const std::string across = "effects: [{anisotropic_friction: {ratio: 0.5}}]\n";
  GraspRig firm_box = held_at(4.0, 4.5, across);
  firm_box.run_to(5.0);
  const double force = firm_box->truth().grip_force;
  EXPECT_NEAR(firm_box->ideal_force(), 4.5 / 2.0, 1e-9);

  GraspRig holds = held_at(2.002, force, across);
  holds.run();
  EXPECT_FALSE(holds->truth().dropped);
  EXPECT_NEAR(holds->ideal_force(), force / 1.001, 1e-9);
  GraspRig drops = held_at(1.998, force, across);
  drops.run();
  EXPECT_TRUE(drops->truth().dropped || drops->truth().left_behind);
}

// A downward pull acts like weight: the pads carry both, and the box slips when their sum is 2 mu
// F.
TEST(GraspStatics, PullOnTheBoxIsCarriedByThePads) {
  const std::string lift = "grip: {}\nmotion: {kind: lift, settle: 1 s, distance: 20 mm}\nduration: 4 s\n";
  GraspRig rig(firm + lift + "box: {push: [[2 s, 0 N, 0 N, 0 N], [2.2 s, 0 N, 1 N, -1.5 N], [4 s, 0 N, 1 N, -1.5 N]]}\n");
  rig.run_to(1.99);
  EXPECT_NEAR(rig.pads_on_box().z(), weight, 1e-3 * weight);
  rig.run_to(3.5);
  EXPECT_NEAR(rig.pads_on_box().z(), weight + 1.5, 1e-3 * weight);
  EXPECT_NEAR(rig.pads_on_box().y(), -1.0, 1e-3 * weight);
  EXPECT_FALSE(rig->truth().dropped);
}

TEST(GraspStatics, PullDropsTheBoxAtTheFrictionLimit) {
  for (const bool beyond : {false, true}) {
    GraspRig firm_box = held_at(2.0, 4.5);
    firm_box.run_to(5.0);
    // At twice the ideal force the pads can carry twice the weight: a pull of one weight is the
    // limit.
    const double limit = 2.0 * (2.0 * weight / (2.0 * 4.5)) * firm_box->truth().grip_force - weight;
    GraspRig rig = held_at(2.0, 4.5,
                           fmt::format("box: {{push: [[3 s, 0 N, 0 N, 0 N], [6 s, 0 N, 0 N, {0} N], [8 s, 0 N, 0 N, {0} N]]}}\n",
                                       -limit * (beyond ? 1.005 : 0.995)));
    rig.run();
    EXPECT_EQ(rig->truth().dropped || rig->truth().left_behind || rig->truth().slip.norm() > 5e-3, beyond);
  }
}

// A pull of 0.5 N down, 30 mm beside the box's middle, turns the box about X like a weight there.
TEST(GraspStatics, PullBesideTheMiddleTurnsTheBox) {
  const std::string lift = "grip: {}\nmotion: {kind: lift, settle: 1 s, distance: 20 mm}\nduration: 4 s\n";
  GraspRig pulled(
      firm + lift +
      "box: {push: [[2 s, 0 N, 0 N, 0 N], [2.2 s, 0 N, 0 N, -0.5 N], [4 s, 0 N, 0 N, -0.5 N]], push_place: [0 mm, 30 mm, 0 mm]}\n");
  const auto roll = [&pulled] { return pulled.body("box").pose.rotation(2, 1); };  // rad, of the box about X, which is small
  pulled.run_to(1.99);
  const double before = roll();
  pulled.run_to(3.5);
  // 15 mN m on 23.2 to 25.6 N m/rad, as derived in CentreOfMassTurnsTheBoxAgainstTheFingers.
  EXPECT_LT(roll() - before, -0.015 / 25.6);
  EXPECT_GT(roll() - before, -0.015 / 23.2);
}

TEST(GraspStatics, HeldBoxDoesNotCreep) {
  GraspRig rig(firm + "grip: {}\nmotion: {kind: lift, settle: 1 s, distance: 20 mm}\nduration: 14 s\n");
  rig.run_to(3.0);
  const Eigen::Vector3d before = rig.box_in_arm();
  rig.run_to(13.0);
  EXPECT_LT((rig.box_in_arm() - before).norm() / 10.0, 0.01e-6);  // m/s
}

TEST(GraspStatics, BoxIsWhereItWasAfterTenMinutes) {
  // In the air from 1.6 s on; the first second of the hold ends at 3 s.
  GraspRig rig("surface: {material: ptfe}\ngrip: {}\nmotion: {kind: lift, settle: 1 s, distance: 20 mm}\nduration: 602 s\n", 0,
               {}, ", rate: 100 Hz");
  rig.run_to(3.0);
  const Eigen::Vector3d before = rig.box_in_arm();
  rig.run();
  EXPECT_EQ(rig->truth().table_force, 0.0);
  EXPECT_LT((rig.box_in_arm() - before).norm(), 1e-6);
}

TEST(GraspStatics, CentreOfMassTurnsTheBoxAgainstTheFingers) {
  // 4 mm beside the pads' middle: 7.848 mN m about X. The silicone pad's rotational stiffness is
  // sum k_t r^2 = 200 N/mm (22^2 (1 - 1/16) + 37.5^2 (1 - 1/36))/12 mm^2 = 30.3 N m/rad, in series
  // with its finger's 100 N m/rad 23.3; all nine pillars would add 2.2, the centre one alone
  // nothing.
  GraspRig rig(
      "friction: {static: 1.2}\ngrip: {preset: 8 N}\nbox: {centre_of_mass: [0 mm, 4 mm, 0 mm]}\n"
      "motion: {kind: lift, settle: 1.5 s, distance: 20 mm}\nduration: 4 s\n");
  rig.run();
  constexpr double moment = weight * 4e-3;
  EXPECT_NEAR(rig.pads_on_box().z(), weight, 1e-3 * weight);
  EXPECT_GT(rig->truth().rotation, moment / (23.3 + 2.3));
  EXPECT_LT(rig->truth().rotation, moment / 23.2);
  EXPECT_LT(rig.body("box").pose.rotation(2, 1), 0.0) << "the heavy side, at +Y, hangs down";
}

}  // namespace
}  // namespace slipbench::grasp_statics_test
