// Two articulated pads hold a free box: the weight, the creep and the force at which the box drops.
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/oracle/pads.h"
#include "tests/sim/mujoco/bodies/dynamic_rig.h"

namespace slipbench {
namespace {

constexpr double g = 9.81, mass = 0.1, half = 0.02;  // m/s2, kg, m

// A free box of 100 g between two pads on slides.
class Grip {
 public:
  // The fingers push with `first` [N] each for 0.1 s, then reduce that to `last` within 0.4 s.
  // `more`: further keys of the box.
  Grip(double k_n, double k_t, double mu, double first, double last, const std::string& more = "") {
    PadLayout pad = oracle::nine_pillars(1, k_n, k_t);
    for (Element& element : pad.elements) {
      // A fiftieth of the heights (4 and 9 um) gives unequal loads with all pillars pressing. On
      // the middle ones alone the box would swing.
      element.tip.z() *= 0.02;
      // Bare springs ring for seconds: these dashpots damp the box on its eighteen pillars at ratio
      // 0.2.
      element.c_tangential = 0.4 * std::sqrt(mass * 18.0 * k_t) / 18.0;
    }
    // Placed so that the pads push with about `first`.
    const double finger = half - first / (9.0 * k_n);
    folder_.write(
        "fingers.xml",
        fmt::format(
            "<mujoco><worldbody><body pos='{0} 0 0'><joint name='left' type='slide' axis='1 0 0' damping='20'/><inertial pos='0 0 0' mass='0.05' diaginertia='1e-4 1e-4 1e-4'/><site name='left' zaxis='-1 0 0'/></body><body pos='{1} 0 0'><joint name='right' type='slide' axis='-1 0 0' damping='20'/><inertial pos='0 0 0' mass='0.05' diaginertia='1e-4 1e-4 1e-4'/><site name='right' zaxis='1 0 0'/></body></worldbody><actuator><motor name='left' joint='left'/><motor name='right' joint='right'/></actuator></mujoco>",
            -finger, finger));
    const std::string push = fmt::format("[[0.1 s, {} N], [0.5 s, {} N]]", first, last);
    rig_ = std::make_unique<DynamicRig>(
        fmt::format("fidelity: articulated\nduration: 5 s\ntime_step: 1 ms\nfriction: {{static: {0}, kinetic: {0}}}\n"
                    "model: fingers.xml\nbodies: {{box: {{shape: box, size: [40 mm, 40 mm, 40 mm], mass: 100 g{1}}}}}\n"
                    "controls: {{left: {2}, right: {2}}}\nsensors:\n"
                    "  left: {{type: papillarray, site: left, touches: [box], damping: 0 s}}\n"
                    "  right: {{type: papillarray, site: right, touches: [box], damping: 0 s}}\n",
                    mu, more, push),
        folder_.file("scene.yaml"), DynamicSimulationOptions{}, &pad);
  }

  // Runs to `time` [s] and returns the height of the box. Times must ascend.
  double height_at(double time) {
    rig_->run_to(time);
    return rig_->body("box").pose.position.z();
  }
  [[nodiscard]] const ContactFrame& frame() { return (*rig_)->contact(1); }
  // Force of the box on the pad, downwards [N].
  [[nodiscard]] double share_of_weight() {
    return -(rig_->body("right").pose.rotation * frame().force.rowwise().sum().matrix()).z();
  }

 private:
  ModelFolder folder_;
  std::unique_ptr<DynamicRig> rig_;
};

TEST(ArticulatedGrip, ABoxDropsJustUnderTheLeastForceAndHoldsJustOverIt) {
  // Two pads carry m g by at most 2 mu F for any shares of the pillars: F = m g/(2 mu). Below it
  // the box falls at g (1 - F/F_least), 0.2 % of g for 0.2 %: 1.6 mm in 0.4 s, and increasingly
  // faster. Above it nothing moves after the transient. Limit: 0.5 %.
  for (const double mu : {0.2, 0.5, 1.0}) {
    const double least = mass * g / (2.0 * mu);
    Grip under(3000.0, 500.0, mu, 2.0 * least, 0.998 * least), over(3000.0, 500.0, mu, 2.0 * least, 1.002 * least);
    const double under_before = under.height_at(0.6), over_before = over.height_at(0.6);
    EXPECT_LT(under.height_at(1.0) - under_before, -0.5 * 0.002 * g * 0.4 * 0.4) << mu;
    EXPECT_EQ(under.frame().state, PadState::gross) << mu;
    EXPECT_GT(over.height_at(1.0) - over_before, -0.5e-6) << mu;
    EXPECT_NE(over.frame().state, PadState::gross) << mu;
  }
}

TEST(ArticulatedGrip, AHeldBoxDoesNotCreepAndItsWeightIsCarried) {
  // At 1.2 times the least force, centred and off centre, each pad carries half the weight and the
  // box does not move. Limit: 0.5 um/s.
  for (const double k_t : {500.0, 3900.0}) {
    for (const std::string more : {"", ", position: [0, 0.13 mm, 0], rotation: [0.004 rad, 0, 0]"}) {
      Grip grip(k_t > 1000.0 ? 7100.0 : 3000.0, k_t, 0.5, 3.0, 1.2 * mass * g, more);
      const double before = grip.height_at(1.0);
      EXPECT_LT(std::abs(grip.height_at(2.0) - before), 0.05e-6) << k_t << more;
      EXPECT_NEAR(grip.share_of_weight(), 0.5 * mass * g, 1e-4 * mass * g) << k_t << more;
    }
  }
}

}  // namespace
}  // namespace slipbench
