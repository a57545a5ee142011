// A box gripped off centre and lifted: it turns on its far edge by rotational slip or lifts off, at
// a known angular speed.
#include <cmath>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "tests/sim/mujoco/bodies/turn_rig.h"

namespace slipbench::grasp_turn_test {
namespace {

// `stiffness` [N/m]: of each element, in all directions.
PadLayout layout_of(const std::vector<Eigen::Vector2d>& places, double stiffness) {
  PadLayout pad;
  for (const Eigen::Vector2d& place : places) {
    pad.units.push_back({pad.elements.size(), 1});
    pad.elements.push_back({.tip = {place.x(), place.y(), 0.0}, .k_normal = stiffness, .k_tangential = stiffness});
  }
  return pad;
}

// Two elements side by side, 8 mm on either side of the pad's middle.
constexpr double half_width = 8e-3, stiff = 30e3;
PadLayout two_abreast() { return layout_of({{-half_width, 0.0}, {half_width, 0.0}}, stiff); }

// Sixteen elements on a circle.
constexpr double radius = 9e-3;
PadLayout ring() {
  std::vector<Eigen::Vector2d> places;
  for (int k = 0; k < 16; ++k) {
    const double angle = 2.0 * std::numbers::pi * (k + 0.5) / 16.0;
    places.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return layout_of(places, 5e3);
}

TEST(GraspTurn, BoxIsTwoMasses) {
  // 118 g spread evenly, and 200 g that are 20 mm towards +Y and 5 mm up. The common centre is at
  // 200/318 of that; the reduced mass is 118 x 200/318 g.
  TurnRig rig(two_abreast(), 0.5, 4, "gravity: 9.81 m/s2\n");
  EXPECT_NEAR(rig->ideal_force(), TurnBox::load / (2.0 * 0.5), 1e-12);
  const Scene scene = parsed(
      "slipbench: 1\nsensors: {pad: {type: papillarray}}\ngrip: {height: 27 mm}\n"
      "box: {mass: 118 g, weight: 200 g, weight_place: [0 mm, 20 mm, 5 mm], size: [33 mm, 155 mm, 54 mm]}\n");
  const PadLayout layout = two_abreast();
  const std::array<const PadLayout*, 1> pads{&layout};
  GraspSimulation simulation(scene, pads, std::array{1000.0}, 0);
  const mjModel* m = simulation.dynamics().model();
  const int body = mj_name2id(m, mjOBJ_BODY, "box");
  EXPECT_NEAR(m->body_mass[body], 0.318, 1e-15);
  EXPECT_NEAR(m->body_ipos[3 * body + 1], 0.020 * 200.0 / 318.0, 1e-15);
  EXPECT_NEAR(m->body_ipos[3 * body + 2], 0.005 * 200.0 / 318.0, 1e-15);
  // In the box's axes, transformed from MuJoCo's principal ones.
  mjtNum turn[9];
  mju_quat2Mat(turn, m->body_iquat + 4 * body);
  const Eigen::Matrix3d axes = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn);
  const Eigen::Matrix3d inertia = axes * Eigen::Vector3d::Map(m->body_inertia + 3 * body).asDiagonal() * axes.transpose();
  const double x2 = 0.033 * 0.033, y2 = 0.155 * 0.155, z2 = 0.054 * 0.054, reduced = 0.118 * 0.2 / 0.318;
  Eigen::Matrix3d expected = Eigen::Vector3d(y2 + z2, z2 + x2, x2 + y2).asDiagonal() * (0.118 / 12.0);
  const Eigen::Vector3d apart(0.0, 0.020, 0.005);
  expected += reduced * (apart.squaredNorm() * Eigen::Matrix3d::Identity() - apart * apart.transpose());
  EXPECT_LT((inertia - expected).norm(), 1e-12 * expected.norm());
}

TEST(GraspTurn, LiesAtRestUntilTheArmIsTold) {
  TurnRig rig(two_abreast(), 0.5, 4);
  rig.run_to(0.9);
  EXPECT_NEAR(rig->truth().table_force, TurnBox::load, 1e-3 * TurnBox::load);
  EXPECT_NEAR(rig->truth().tilt, 0.5 * std::numbers::pi, 1e-4);
  EXPECT_TRUE(std::isinf(rig->lift_start()));
  EXPECT_EQ(rig->truth().slip, Eigen::Vector3d::Zero());
  rig.run_to(1.1);
  EXPECT_DOUBLE_EQ(rig->lift_start(), 1.0);
}

// Off the table each of two equal pads carries m g/2 and the moment m g lever/2. With two elements
// side by side statics gives their loads, both upwards: m g/4 (1 +- lever/half_width). The more
// loaded one can carry mu N/2, so the box lifts off without turning if N >= m g/(2 mu) (1 +
// lever/half_width), and otherwise turns on its far edge.
TEST(GraspTurn, LiftsOffRigidlyAboveTheClosedFormAndTurnsBelow) {
  constexpr int counts = 9;
  constexpr double ratio = 1.0 + TurnBox::lever / half_width;
  // The grip force depends on the geometry alone, so that of a firmly held box applies to the
  // others.
  TurnRig firm(two_abreast(), 10.0, counts);
  firm.run_to(0.99);
  const double force = firm->truth().grip_force;
  EXPECT_GT(force, 5.0);

  TurnRig holds(two_abreast(), 1.005 * ratio * TurnBox::load / (2.0 * force), counts);
  holds.run_to(8.0);  // 2 mm/s after 2 s: 12 mm in all
  EXPECT_NEAR(holds->truth().grip_force, force, 2e-3 * force);
  EXPECT_EQ(holds->truth().table_force, 0.0);
  // Compliance alone: two pads' elements, 2 k a^2 each, in series with the fingers' 100 N m/rad,
  // under m g lever; plus 30 %.
  const double give = TurnBox::load * TurnBox::lever * 0.5 * (1.0 / (2.0 * stiff * half_width * half_width) + 1.0 / 100.0);
  EXPECT_LT(holds->truth().rotation, 1.3 * give);

  TurnRig turns(two_abreast(), 0.995 * ratio * TurnBox::load / (2.0 * force), counts);
  turns.run_to(8.0);
  EXPECT_GT(turns->truth().table_force, 0.0);
  // 12 mm over the distance from the edge to the sticking element, minus the compliance.
  constexpr double turned = 12e-3 / (0.5 * TurnBox::length + TurnBox::lever);
  EXPECT_NEAR(turns->truth().rotation, turned, 0.15 * turned);
}

// Eq. (5) of the nib paper: theta' = v/(l cos theta). The edge does not rise, and the point about
// which the box slips in the pads rises with the pads, so v = theta' times their horizontal
// distance. Pads that also carry a load slip about a point beside their middle: for a ring with the
// share e of its friction in that load it is 2 e radius away, here e <= m g/(2 mu N).
TEST(GraspTurn, AngularSpeedIsThatOfEquationFive) {
  TurnRig rig(ring(), 1.0, 3);
  rig.lift_speed = 10e-3;
  rig.run_to(0.99);
  const double force = rig->truth().grip_force;
  const double aside = 2.0 * TurnBox::load / (2.0 * force) * radius;
  ASSERT_LT(aside, 0.06 * 0.1375);
  for (const double time : {13.0, 14.0, 15.0, 16.0}) {
    rig.run_to(time);
    const BodyState &arm = rig.body("arm"), &box = rig.body("box");
    ASSERT_GT(rig->truth().table_force, 0.0);
    ASSERT_EQ(rig->contact(0).state, PadState::gross);
    const double level = (arm.pose.position - rig.edge()).y();  // l cos theta
    const double spin = box.angular_velocity.x();
    EXPECT_NEAR(arm.velocity.z(), 10e-3, 1e-12);
    EXPECT_NEAR(spin * level, 10e-3, 1.2 * aside / level * 10e-3) << time;
    const Eigen::Array2d centre = rig->contact(0).slip_centre;  // in the pad frame, whose x is the world's -Y and whose y is up
    EXPECT_NEAR(spin * (level - centre.x()), 10e-3, 0.01 * 10e-3) << time;
  }
}

}  // namespace
}  // namespace slipbench::grasp_turn_test
