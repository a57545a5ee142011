// One element against closed forms: touch, slip and detach inside a step, reversal, stop, dashpot.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::field_law_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0;

double event_time(const Field& field, int tick, double dt) { return (tick - 1 + field.events().front().fraction) * dt; }

TEST(FieldLaw, TouchInsideAStepAnchorsWhereItTouched) {
  // The tip comes down at w from g and moves sideways at v: it touches at g/w, and from then on the
  // stretch is v (t - g/w). Friction of 5 holds it: k_t v <= 5 k_n w.
  const double gap = 0.1e-3, w = 3e-3, v = 8e-3, touch = gap / w;
  for (const double dt : {1e-3, 7e-3, 13e-3, 0.2}) {
    Field field(one_element(k_n, k_t), Plane{}, {5.0, 5.0});
    for (int tick = 0; tick * dt < 0.25; ++tick) {
      const double t = tick * dt;
      field.step(at(v * t, 0.0, gap - w * t), dt);
      if (t <= touch) continue;
      ASSERT_EQ(field.state(0), ElementState::stick);
      EXPECT_NEAR(field.stretch(0).x(), v * (t - touch), 1e-15) << "dt " << dt;
      EXPECT_NEAR(field.tangential_force(0).x(), k_t * v * (t - touch), 1e-12);
      EXPECT_NEAR(field.normal_force(0), k_n * w * (t - touch), 1e-12);
    }
  }
}

TEST(FieldLaw, DashpotDoesNotMoveTheInstantOfTouch) {
  // Half of the first step's way down is in air, so it touches in the middle of the step for any
  // element.
  for (const double c_n : {0.0, 10.0}) {
    Field field(one_element(k_n, k_t, c_n), Plane{}, {5.0, 5.0});
    field.step(at(0.0, 0.0, 0.1e-3), 1e-3);
    field.step(at(0.2e-3, 0.0, -0.1e-3), 1e-3);
    ASSERT_EQ(field.events().size(), 1U);
    EXPECT_NEAR(field.events()[0].fraction, 0.5, 1e-12) << "c_n " << c_n;
    EXPECT_NEAR(field.stretch(0).x(), 0.1e-3, 1e-15) << "c_n " << c_n;
  }
}

TEST(FieldLaw, TimesOfTouchAndDetachAreThoseOfTheMotion) {
  const double gap = 0.1e-3, w = 3e-3, turn = 0.1,
               dt = 7e-3;  // down until `turn`, then up again: touch at g/w, detach at 2 turn - g/w
  Field field(one_element(k_n, k_t), Plane{}, {0.5, 0.5});
  std::vector<double> times;
  for (int tick = 0; tick < 40; ++tick) {
    const double t = tick * dt;
    field.step(at(0.0, 0.0, gap - w * (t < turn ? t : 2.0 * turn - t)), dt);
    if (!field.events().empty()) times.push_back(event_time(field, tick, dt));
  }
  ASSERT_EQ(times.size(), 2U);
  EXPECT_NEAR(times[0], gap / w, 1e-12);
  EXPECT_NEAR(times[1], 2.0 * turn - gap / w, 1e-12);
}

TEST(FieldLaw, OnsetWhileTheLoadFalls) {
  // k_t v t = mu k_n (d - w t), so t = mu k_n d/(k_t v + mu k_n w). Both sides are linear in t:
  // exact for any step.
  const double mu = 0.5, depth = 1e-3, v = 4e-3, w = 2e-3;
  const double exact = mu * k_n * depth / (k_t * v + mu * k_n * w);
  for (const double dt : {1e-3, 17e-3, 0.2}) {
    Field field(one_element(k_n, k_t), Plane{}, {mu, mu});
    bool found = false;
    for (int tick = 0; tick * dt < 0.45 && !found; ++tick) {
      const double t = tick * dt;
      field.step(at(v * t, 0.0, -depth + w * t), dt);
      found = field.state(0) == ElementState::slip;
      if (found) {
        EXPECT_NEAR(event_time(field, tick, dt), exact, 1e-12) << "dt " << dt;
      }
    }
    EXPECT_TRUE(found);
  }
}

TEST(FieldLaw, ReversalSticksFirstAndSlipsAfterBothStretches) {
  // Sliding forward the stretch is mu_k f_n/k_t; reversed at v it sticks until the stretch is -mu_s
  // f_n/k_t.
  const double mu_s = 0.5, mu_k = 0.4, depth = 1e-3, v = 4e-3, dt = 1e-3;
  const int turn = 600;
  Field field(one_element(k_n, k_t), Plane{}, {mu_s, mu_k});
  const double back = (mu_s + mu_k) * k_n * depth / (k_t * v);  // 0.375 s
  std::vector<double> times;
  std::vector<ElementState> states;
  for (int tick = 0; tick < 1200; ++tick) {
    field.step(at(v * dt * (tick < turn ? tick : 2 * turn - tick), 0.0, -depth), dt);
    for (std::size_t k = 0; k < field.events().size(); ++k) {
      times.push_back(event_time(field, tick, dt));
      states.push_back(field.events()[k].to);
    }
  }
  using enum ElementState;
  ASSERT_EQ(states, (std::vector<ElementState>{stick, slip, stick, slip}));
  EXPECT_NEAR(times[1], mu_s * k_n * depth / (k_t * v), 1e-12);
  EXPECT_NEAR(times[2], turn * dt, 1e-12);
  EXPECT_NEAR(times[3], turn * dt + back, 1e-12);
  EXPECT_NEAR(field.tangential_force(0).x(), -mu_k * k_n * depth, 1e-12);
}

TEST(FieldLaw, PadThatStopsSticks) {
  // A slide that ends leaves every element on its cone without motion: it sticks, whatever the last
  // bit of its force.
  for (int direction = 0; direction < 16; ++direction) {
    for (const double mu : {0.2, 0.37, 0.5, 0.81}) {
      const double angle = 0.1 + direction * std::numbers::pi / 8.0, v = 4e-3, dt = 1e-3;
      Field field(oracle::nine_pillars(6), Plane{}, {mu, mu});
      const auto pose = [&](double t) { return at(v * t * std::cos(angle), v * t * std::sin(angle), -1e-3); };
      for (int tick = 0; tick <= 1000; ++tick) field.step(pose(tick * dt), dt);
      for (int tick = 0; tick < 20; ++tick) field.step(pose(1.0), dt);
      int still_slipping = 0;
      for (std::size_t i = 0; i < field.size(); ++i) still_slipping += field.state(i) == ElementState::slip;
      EXPECT_EQ(still_slipping, 0) << "direction " << direction << ", mu " << mu << ", of " << field.size() << " elements";
    }
  }
}

TEST(FieldLaw, FrictionlessSurfaceHoldsNothingSideways) {
  const double v = 4e-3, dt = 1e-3;
  Field field(one_element(k_n, k_t), Plane{}, {0.0, 0.0});
  for (int tick = 0; tick <= 100; ++tick) {
    field.step(at(v * tick * dt, 0.0, -1e-3), dt);
    EXPECT_EQ(field.tangential_force(0).norm(), 0.0);
    EXPECT_NEAR(field.normal_force(0), 1.0, 1e-12);  // k_n times 1 mm
  }
  EXPECT_EQ(field.state(0), ElementState::slip);
  EXPECT_NEAR(field.slip_path(0), 100 * v * dt, 1e-15);  // all of the way
  EXPECT_LT(field.wrench_on_pad().force.head<2>().norm(), 1e-300);
}

TEST(FieldLaw, PlateMovingUnderAStillPadDragsItAlong) {
  // Friction pulls the pad along with the plate with k_t v t; turned by theta about a tip at radius
  // r the chord is 2 r sin(theta/2).
  const double v = 4e-3;
  Field field(one_element(k_n, k_t), Plane{}, {5.0, 5.0});
  for (int tick = 0; tick <= 100; ++tick) {
    const Pose plate = at(v * tick * 1e-3, 0.0, 0.0);
    field.step(plate.inverse() * at(0.0, 0.0, -1e-3), 1e-3);
  }
  EXPECT_NEAR(field.wrench_on_pad().force.x(), k_t * v * 0.1, 1e-12);
  EXPECT_NEAR(field.wrench_on_pad().force.z(), k_n * 1e-3, 1e-12);

  PadLayout pad = one_element(k_n, k_t);
  const double r = 7e-3, theta = 0.2;
  pad.elements[0].tip.x() = r;
  Field turning(pad, Plane{}, {5.0, 5.0});
  for (int tick = 0; tick <= 100; ++tick)
    turning.step(oracle::turned(theta * tick / 100.0, Eigen::Vector3d::Zero()).inverse() * at(0.0, 0.0, -1e-3), 1e-3);
  // The anchor is at r (cos theta, sin theta): force on the pad k_t r (cos theta - 1, sin theta),
  // torque k_t r^2 sin theta.
  EXPECT_NEAR(turning.wrench_on_pad().force.x(), k_t * r * (std::cos(theta) - 1.0), 1e-12);
  EXPECT_NEAR(turning.wrench_on_pad().force.y(), k_t * r * std::sin(theta), 1e-12);
  EXPECT_NEAR(turning.wrench_on_pad().torque.z(), k_t * r * r * std::sin(theta), 1e-14);
}

TEST(FieldLaw, DashpotsAddTheRateOfTheStep) {
  // Both deflections grow at constant rates, so the step's rate is the true one: f_n = k_n w t +
  // c_n w, f_t = k_t v t + c_t v.
  const double c_n = 5.0, c_t = 3.0, w = 3e-3, v = 4e-3, dt = 1e-3;
  Field field(one_element(k_n, k_t, c_n, c_t), Plane{}, {9.0, 9.0});
  for (int tick = 0; tick <= 100; ++tick) {
    const double t = tick * dt;
    field.step(at(v * t, 0.0, -w * t), dt);
    if (tick == 0) continue;
    EXPECT_NEAR(field.normal_force(0), k_n * w * t + c_n * w, 1e-12);
    EXPECT_NEAR(field.tangential_force(0).x(), k_t * v * t + c_t * v, 1e-12);
  }
}

TEST(FieldLaw, DashpotNeverPullsAndSteadySlideForgetsIt) {
  // Lifted at w the element pushes with k_n d - c_n w while that is positive: never below zero.
  const double c_n = 5.0, c_t = 3.0, mu = 0.5, depth = 1e-3, v = 4e-3, dt = 1e-3;
  Field field(one_element(k_n, k_t, c_n, c_t), Plane{}, {mu, mu});
  double t = 0.0;
  for (int tick = 0; tick <= 500; ++tick) field.step(at(v * (t = tick * dt), 0.0, -depth), dt);
  EXPECT_EQ(field.state(0), ElementState::slip);
  EXPECT_NEAR(field.tangential_force(0).x(), mu * k_n * depth, 1e-12);
  // The stretch reaches mu f_n/k_t with the time constant c_t/k_t = 5 ms: after some 100 of them
  // nothing is left.
  EXPECT_NEAR(field.stretch(0).x(), mu * k_n * depth / k_t, 1e-15);
  for (const double w : {0.1, 0.15, 0.25}) {  // c_n w: 0.5, 0.75, 1.25 N against k_n d of 1 N at most
    Field lifted(one_element(k_n, k_t, c_n, c_t), Plane{}, {mu, mu});
    lifted.step(at(0.0, 0.0, -depth), dt);
    lifted.step(at(0.0, 0.0, -depth + w * dt), dt);
    EXPECT_NEAR(lifted.normal_force(0), std::max(0.0, k_n * (depth - w * dt) - c_n * w), 1e-12) << "w " << w;
  }
}

TEST(FieldLaw, FirstStepSticksUnstrained) {
  Field field(one_element(k_n, k_t), Plane{}, {0.1, 0.1});
  field.step(at(5e-3, -2e-3, -1e-3), 1e-3);
  EXPECT_EQ(field.state(0), ElementState::stick);
  EXPECT_EQ(field.tangential_force(0).norm(), 0.0);
  EXPECT_EQ(field.slip_path(0), 0.0);
  ASSERT_EQ(field.events().size(), 1U);
  EXPECT_EQ(field.events()[0].fraction, 1.0);
}

TEST(FieldLaw, ElementThatLooksAwayNeverTouches) {
  PadLayout pad = one_element(k_n, k_t);
  pad.elements[0].axis = {0.0, 0.0, 1.0};
  const double deep = -1e-3;
  for (const Shape shape : all_shapes) {
    const Target target = testing_field::target(shape);
    Field field(pad, target.surface, {0.5, 0.5});
    field.step(target.facing * at(0.0, 0.0, deep), 1e-3);
    EXPECT_EQ(field.state(0), ElementState::detached) << "shape " << static_cast<int>(shape);
    EXPECT_EQ(field.normal_force(0), 0.0);
  }
}

TEST(FieldLaw, CompressionBeyondTheHeightOfAUnitIsReported) {
  // Tips 5 mm above the pad's origin, that of the element `low` 1 mm lower, on a pad pressed by z
  // [mm]: depths of z - 5 and z - 4. A sparse field and one with entries of the padding, whose
  // tips are at the origin, z deep.
  constexpr double height = 3e-3;
  for (const int n : {1, 3, 9}) {
    PadLayout pad = oracle::square_grid(n, 5e-3, k_n, k_t);
    const std::size_t low = pad.elements.size() / 2;
    for (Element& element : pad.elements) element.tip.z() = 5e-3;
    pad.elements[low].tip.z() = 4e-3;
    for (const Surface& surface : {Surface(Plane{}), Surface(Box{{20e-3, 20e-3, 20e-3}})}) {
      const double top = std::holds_alternative<Plane>(surface) ? 0.0 : 20e-3;
      const auto reported = [&](double limit, double z) {
        pad.unit_height = limit;
        Field field(pad, surface, {0.5, 0.5});
        for (const double each : {0.0, z}) field.step(at(0.0, 0.0, top - each), 1e-3);
        return field.overcompressed();
      };
      EXPECT_EQ(reported(height, 6.9e-3), std::nullopt) << n;
      EXPECT_EQ(reported(height, 7.1e-3), low) << n;
      EXPECT_EQ(reported(height, 8.1e-3), 0U) << n;
      EXPECT_EQ(reported(std::numeric_limits<double>::infinity(), 8.1e-3), std::nullopt) << n;
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_field::field_law_test
