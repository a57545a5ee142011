// A field's state is all that its next steps need: loaded into another field, it continues
// bit-identically.

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "tests/sim/contact/same_field.h"

namespace slipbench::testing_field::state_test {
namespace {

TEST(FieldState, LoadedIntoANewFieldGoesOnToTheSameBits) {
  int slid = 0, events = 0;
  for (const Shape shape : all_shapes) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      RandomStream draw(seed, 0, "field state");
      const Target met = target(shape);
      const PadLayout pad = random_pad(draw, 60, seed % 2 == 1);  // with dashpots every other time
      const Friction friction = random_friction(draw);
      const RandomMotion motion(draw, met.facing);
      Field field(pad, met.surface, friction);
      for (const int saved_at : {0, 1, 60, 150}) {  // 0: never stepped
        Field lasting(pad, met.surface, friction);
        for (int tick = 0; tick < saved_at; ++tick) lasting.step(motion.at(tick * 1e-3), 1e-3);
        std::vector<double> state(lasting.state_size());
        lasting.save_state(state);
        if (saved_at == 0) {
          EXPECT_EQ(state, std::vector<double>(state.size())) << "zeros stand for a field that was never stepped";
        }
        field.load_state(state);  // a field with the past of the round before
        std::vector<double> again(state.size());
        field.save_state(again);
        EXPECT_EQ(again, state);
        for (int tick = saved_at; tick < saved_at + 60; ++tick) {
          lasting.step(motion.at(tick * 1e-3), 1e-3);
          field.step(motion.at(tick * 1e-3), 1e-3);
          ASSERT_TRUE(same_bits(lasting, field))
              << "shape " << static_cast<int>(shape) << ", seed " << seed << ", saved at " << saved_at << ", tick " << tick;
          events += static_cast<int>(field.events().size());
          for (std::size_t i = 0; i < field.size(); ++i) slid += field.state(i) == ElementState::slip ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(slid, 10000);
  EXPECT_GT(events, 1000);
}

TEST(FieldState, TrialsFromOneStateDoNotSeeEachOther) {
  RandomStream draw(3, 0, "field trials");
  const PadLayout pad = random_pad(draw, 40, true);
  const RandomMotion motion(draw, Pose{}), elsewhere(draw, Pose{});
  Field tried(pad, Plane{}, {0.5, 0.4}), plain(pad, Plane{}, {0.5, 0.4});
  std::vector<double> state(tried.state_size());
  for (int tick = 0; tick < 200; ++tick) {
    tried.load_state(state);
    tried.step(elsewhere.at(tick * 1e-3), 1e-3);
    tried.load_state(state);
    tried.step(motion.at(tick * 1e-3), 1e-3);
    tried.save_state(state);
    plain.step(motion.at(tick * 1e-3), 1e-3);
    ASSERT_TRUE(same_bits(plain, tried)) << "tick " << tick;
  }
}

TEST(FieldState, DampedWrenchIsThatOfEveryElementByItself) {
  // The law of damped_wrench_on_pad(), element by element from the accessors, against the sum by
  // lanes: equal up to the rounding of a sum of some 60 forces.
  const double tau = 2e-3;
  int held_on_cone = 0, let_go = 0;
  for (const Shape shape : all_shapes) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      RandomStream draw(seed, 1, "damped wrench");
      const Target met = target(shape);
      const PadLayout pad = random_pad(draw, 61, false);
      const Friction friction = random_friction(draw);
      const RandomMotion motion(draw, met.facing);
      Field field(pad, met.surface, friction);
      for (int tick = 0; tick < 100; ++tick) {
        field.step(motion.at(tick * 1e-3), 1e-3);
        const Twist twist{Eigen::Vector3d(draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5), draw.uniform(-0.5, 0.5)),
                          Eigen::Vector3d(draw.uniform(-9.0, 9.0), draw.uniform(-9.0, 9.0), draw.uniform(-9.0, 9.0))};
        Wrench exact{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
        double sum = 0.0;
        for (std::size_t i = 0; i < field.size(); ++i) {
          if (field.state(i) == ElementState::detached) continue;
          const Eigen::Vector3d n = field.normal(i), arm = field.contact_point(i) - field.pad_in_surface().position;
          const Eigen::Vector3d velocity = twist.linear + twist.angular.cross(arm);
          const double along = n.dot(velocity), pressed = field.normal_force(i) - tau * pad.elements[i].k_normal * along;
          Eigen::Vector3d dragged = field.tangential_force(i);
          if (field.state(i) == ElementState::stick) {
            dragged += tau * pad.elements[i].k_tangential * (velocity - along * n);
            if (dragged.norm() > field.stick_limit(i)) {
              dragged *= field.stick_limit(i) / dragged.norm();
              ++held_on_cone;
            }
          }
          let_go += pressed < 0.0 ? 1 : 0;
          const Eigen::Vector3d force = std::max(0.0, pressed) * n - dragged;
          exact.force += force;
          exact.torque += arm.cross(force);
          sum += force.norm();
        }
        const Wrench wrench = field.damped_wrench_on_pad(twist, tau);
        ASSERT_LE((wrench.force - exact.force).norm(), 1e-13 * sum);
        ASSERT_LE((wrench.torque - exact.torque).norm(), 1e-13 * 0.05 * sum);  // the arms are shorter than 50 mm
        const Wrench undamped = field.damped_wrench_on_pad({}, tau), springs = field.wrench_on_pad();
        ASSERT_LE((field.pad_in_surface().rotation * springs.force - undamped.force).norm(), 1e-13 * sum + 1e-15);
      }
    }
  }
  EXPECT_GT(held_on_cone, 1000);
  EXPECT_GT(let_go, 1000);
}

}  // namespace
}  // namespace slipbench::testing_field::state_test
