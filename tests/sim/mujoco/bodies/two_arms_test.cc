// Two arms hold an object between Myrmex arrays (scenes/myrmex/two_arms.xml) and open, against
// closed forms.
#include <cmath>

#include "tests/expect.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench::two_arms_test {
namespace {

constexpr double gravity = 9.81, mass = 0.25, mu = 0.5;
// From the model, and from 96 taxels (6 x 16 on a face 30 mm wide) of 20 kPa (5 mm)^2/5 mm = 100
// N/m.
constexpr double arm = 5000.0, arm_damping = 140.0, foam = 9600.0, pad_damping = 1e-3 * foam;

// `object`: its shape and position; the finger stays away.
std::string scene(const std::string& object, const std::string& controls, double duration) {
  return "duration: " + std::to_string(duration) +
         " s\ntime_step: 1 ms\nsurface: {material: acrylic}\nfriction: {static: 0.5, kinetic: 0.5}\nmodel: two_arms.xml\n"
         "bodies: {object: {shape: box, mass: 250 g, " +
         object + "}}\ngravity: 9.81 m/s2\ncontrols: {touch: 120 mm, " + controls +
         "}\nsensors:\n  left: {type: myrmex, site: left_pad, touches: [object]}\n  right: {type: myrmex, site: right_pad, touches: [object]}\n";
}

const std::string scene_file = std::string(SLIPBENCH_SOURCE_DIR) + "/scenes/myrmex/test.yaml";
const std::string upright = "size: [60 mm, 30 mm, 160 mm], position: [0 mm, 0 mm, 10 mm]";
const std::string lying = "size: [60 mm, 160 mm, 30 mm], position: [0 mm, 35 mm, 0 mm]";

// With v the opening speed of the arms' command, an arm and its foam in series, both dragged by
// their dampers:
//   (arm + foam) q = arm (squeeze - v t) + (arm_damping + pad_damping) v arm/(arm + foam),
// and all taxels, equally pressed and sheared, slip when the load foam q is m g/(2 mu).
TEST(TwoArms, LetTheObjectSlipAtTheWeightOverTwoMu) {
  DynamicRig rig(scene(upright, "squeeze: 5 mm, apart: [[2.5 s, 0 mm], [9.5 s, 7 mm]]", 8.0), scene_file);
  const double load = mass * gravity / (2.0 * mu);
  const double drag = (arm_damping + pad_damping) * 1e-3 * arm / (arm + foam);
  const double opened = 5e-3 - (load / foam * (arm + foam) - drag) / arm;  // m
  double slips = 0.0, held = 0.0;
  for (std::size_t tick = 0; tick < rig->ticks(0) && slips == 0.0; ++tick) {
    rig->step();
    const ContactFrame &left = rig->contact(0), &right = rig->contact(1);
    if (left.time > 2.5 && left.state == PadState::gross && right.state == PadState::gross) {
      slips = left.time;
      held = left.contact_force.row(2).sum();
    }
  }
  EXPECT_NEAR(slips, 2.5 + opened / 1e-3, 2e-3)
      << "found at the end of a step; the ramp's beginning has died away to less than one";
  EXPECT_NEAR(held / load, 1.0, 2e-3) << "2 ms of the ramp are 3.3 mN of 2.45 N each";
}

// The least force on each pad that holds the horizontal object with its centre of mass at d to the
// side: a rigid body slips everywhere except at one point, about which it turns, with equal loads
// on all taxels. With c the position of that point, r_i the distances from it, and y to the side:
//   vertical  mu F mean((y_i - c)/r_i) = m g/2,   about the centre of mass  sum ((y_i - c)(y_i - d) + z_i^2)/r_i = 0.
double least_force(double d) {
  const auto sums = [d](double c) {
    double lift = 0.0, moment = 0.0;
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 16; ++column) {
        const double y = 5e-3 * (column - 7.5), z = 5e-3 * (row - 2.5), r = std::hypot(y - c, z);
        lift += (y - c) / r / 96.0;
        moment += ((y - c) * (y - d) + z * z) / r;
      }
    }
    return std::pair(lift, moment);
  };
  double low = -0.5,
         high = 0.02;  // far: a translation, where the weight turns it about the pads; near the mass the pads turn it back
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (low + high);
    (sums(middle).second < 0.0 ? low : high) = middle;
  }
  return 0.5 * mass * gravity / (mu * sums(low).first);
}

TEST(TwoArms, HoldAnObjectBesideItsMassByTheTwistingFrictionOfThePads) {
  const double least = least_force(35e-3);
  // A translation would need 2.45 N. A line contact of 80 mm with even load, a = 40 mm, would need
  // 1/s of that, s = sqrt(1 + (d/a)^2) - d/a: 2.45/0.454 = 5.40 N; the strip's width of 30 mm
  // reduces that.
  EXPECT_GT(least, 2.45);
  EXPECT_LT(least, 5.40);
  for (const double share : {1.1, 0.9}) {
    const double opened = 5e-3 - share * least * (1.0 / arm + 1.0 / foam);
    DynamicRig rig(scene(lying, "squeeze: 5 mm, apart: [[0.5 s, 0 mm], [2.5 s, " + std::to_string(1e3 * opened) + " mm]]", 5.0),
                   scene_file);
    rig.run_to(3.0);
    const BodyState early = rig.body("object");
    rig.run_to(4.9);
    const BodyState late = rig.body("object");
    const double turned = std::acos(std::min(1.0, early.pose.rotation.col(2).dot(late.pose.rotation.col(2))));
    if (share > 1.0) {
      EXPECT_LT(turned, 1e-3) << "it hangs, elastically turned, and stays";
      EXPECT_GT(late.pose.position.z(), -5e-3);
    } else {
      EXPECT_LT(late.pose.position.z(), -20e-3) << "it has turned down";
    }
  }
}

TEST(Bodies, HollowCylinderHasItsOwnInertia) {
  register_plugin_once();
  const std::string pad =
      "}\nduration: 1 s\ntime_step: auto\nsurface: {material: glass}\nmotion: {kind: stage}\nsensors: {pad: {type: papillarray, touches: [glass]}}\n";
  DynamicRig rig(
      "bodies: {glass: {shape: cylinder, radius: 30 mm, bore: 27 mm, length: 120 mm, mass: 300 g, centre_of_mass: [0, 0, 10 mm], position: [0, 0, -60 mm]}" +
      pad);
  const mjModel* m = rig->model();
  const int body = mj_name2id(m, mjOBJ_BODY, "glass");
  EXPECT_DOUBLE_EQ(m->body_mass[body], 0.3);
  EXPECT_DOUBLE_EQ(m->body_ipos[3 * body + 2], 0.01);
  // R^2 + r^2 = 1,629 mm2: I_z = 0.15 kg times that, I_x = 0.025 kg (3 * 1,629 mm2 + 14,400 mm2).
  EXPECT_NEAR(m->body_inertia[3 * body + 2], 0.15 * 1629e-6, 1e-12);
  EXPECT_NEAR(m->body_inertia[3 * body], 0.025 * (3.0 * 1629e-6 + 14400e-6), 1e-12);
  EXPECT_NEAR(m->body_inertia[3 * body + 1], m->body_inertia[3 * body], 1e-15);
  EXPECT_THAT([&] { DynamicRig("bodies: {glass: {shape: cylinder, radius: 30 mm, bore: 30 mm}" + pad); },
              testing::ThrowsMessage<InputError>(refused_at("bodies.glass.bore", {"30 mm", "radius"})));
}

}  // namespace
}  // namespace slipbench::two_arms_test
