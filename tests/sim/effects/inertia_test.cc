// Tips with mass in a field: labels, sensor readings, and effects that inertia excludes. The law
// itself is tested in tests/oracle/inertia_test.cc.
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "sim/contact/contact_labels.h"
#include "sim/effects/install.h"
#include "tests/expect.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::inertia_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0, depth = 1e-3;

TEST(InertiaLabels, TheMarginIsOfFrictionAndTheForceIsFelt) {
  const double mu_s = 0.6, mu_k = 0.4, dt = 1e-4;
  Field field = field_with(one_unit(k_n, k_t), {mu_s, mu_k}, {{"inertia", {{"damping", 0.05}}}});
  ContactLabels labels(field.layout());
  int slid = 0;
  double farthest = 0.0;  // largest distance of the felt force from friction during slip
  for (int tick = 0; tick < 10000; ++tick) {
    field.step(at(2e-6 * tick, 0.0, -depth), dt);
    const ContactFrame& frame = labels.update({&field, 1}, tick * dt, dt);
    const double friction = field.tangential_force(0).norm(), felt = -frame.force(0, 0);
    EXPECT_NEAR(frame.margin[0], 1.0 - friction / (mu_s * k_n * depth), 1e-12);
    EXPECT_GE(frame.margin[0], -1e-9);
    EXPECT_DOUBLE_EQ(-frame.contact_force(0, 0), felt);
    EXPECT_DOUBLE_EQ(-frame.force(0, 0), -field.wrench_on_pad().force.x());
    if (frame.unit_state[0] != UnitState::slip) {
      EXPECT_NEAR(felt, friction, 1e-9);
      continue;
    }
    ++slid;
    EXPECT_NEAR(friction, mu_k * k_n * depth, 1e-12);
    farthest = std::max(farthest, std::abs(felt - friction));
  }
  // Every cycle has half a swing of at least 2.8 ms, plus at most 2 (mu_s - mu_k) f_n/(k_t v) = 33
  // ms, from 50 ms on: more than 7 % of 9500.
  EXPECT_GT(slid, 665);
  // It begins to slip at (mu_s - mu_k) f_n from equilibrium, and swings beyond that with the speed
  // of the root.
  EXPECT_GT(farthest, 0.9 * (mu_s - mu_k) * k_n * depth);
}

// slip_velocity is 0 while the tip sticks, also in the step within which it came to rest.
TEST(InertiaLabels, ATipThatSticksHasNoSlipVelocity) {
  const double dt = 1e-3;
  Field field = field_with(one_unit(k_n, k_t), {0.6, 0.4}, {{"inertia", {{"damping", 0.05}}}});
  ContactLabels labels(field.layout());
  int came_to_rest = 0;
  double way = 0.0;
  for (int tick = 0; tick < 3000; ++tick) {
    field.step(at(20e-6 * tick, 0.0, -depth), dt);
    const ContactFrame& frame = labels.update({&field, 1}, tick * dt, dt);
    const double slipped = frame.slip_distance[0] - way;
    way = frame.slip_distance[0];
    if (frame.unit_state[0] == UnitState::slip) {
      EXPECT_GT(frame.slip_velocity.matrix().norm(), 0.0);
      continue;
    }
    came_to_rest += slipped > 0.0 ? 1 : 0;
    EXPECT_EQ(frame.slip_velocity.matrix().norm(), 0.0) << tick;
  }
  // Every stick-slip cycle ends in a step with both: one in at most 33 ms at 2 mm/s, ten times as
  // often at 20 mm/s.
  EXPECT_GT(came_to_rest, 50);
}

// A lifted tip continues to swing, so that the force at its root has a direction. Labels give it in
// the plane of the surface that the tip left, which is level, whatever tilted surface another unit
// touches.
TEST(InertiaLabels, WhatRingsInTheAirIsNotTurnedByAnotherUnitsSurface) {
  const double dt = 1e-4, mu = 0.6, dragged = 0.2e-3;
  PadLayout pad;
  for (const double x : {0.0, 10e-3}) {
    Element element;
    element.tip = {x, 0.0, 0.2 * x};  // the second stays above the level surface
    element.k_normal = k_n;
    element.k_tangential = k_t;
    pad.units.push_back({pad.elements.size(), 1});
    pad.elements.push_back(element);
  }
  std::vector<Field> fields;
  for (int k = 0; k < 2; ++k) fields.push_back(field_with(pad, {mu, mu}, {{"inertia", {{"damping", 0.05}}}}));
  Pose tilted;  // 30 degrees about y: the second tip is 0.5 mm under the surface, the first one above it
  tilted.rotation = Eigen::AngleAxisd(std::numbers::pi / 6.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  tilted.position.z() = -0.5e-3 - (tilted.rotation * pad.elements[1].tip).z();
  ContactLabels labels(pad);
  double most = 0.0;
  for (int tick = 0; tick < 60; ++tick) {
    const bool lifted = tick >= 40;
    fields[0].step(at(dragged * std::min(1.0, tick / 30.0), 0.0, lifted ? 0.1e-3 : -depth), dt);
    fields[1].step(tilted, dt);
    const ContactFrame& frame = labels.update(fields, tick * dt, dt);
    ASSERT_EQ(frame.unit_state[1], UnitState::stick);
    ASSERT_EQ(frame.unit_state[0], lifted ? UnitState::detached : UnitState::stick);
    EXPECT_EQ((frame.contact_force.col(0) - frame.force.col(0)).abs().maxCoeff(), 0.0) << tick;
    if (lifted) most = std::max(most, std::abs(frame.force(0, 0)));
  }
  // It is released at k_t x = 0.12 N; damped at 0.05, the swing has exp(-0.05 pi) = 85 % left at
  // its other end.
  EXPECT_GT(most, 0.8 * k_t * dragged);
}

TEST(InertiaLabels, EveryChangeInsideAStepIsToldInOrder) {
  // A step of 50 ms at 20 mm/s: 1 mm, several times the stretch of the tip between two slips.
  const double dt = 50e-3;
  Field field = field_with(one_unit(k_n, k_t), {0.3, 0.2}, {{"inertia", {{"damping", 0.0}}}});
  ContactLabels labels(field.layout());
  std::size_t most = 0;
  ElementState state = ElementState::detached;
  for (int tick = 0; tick < 20; ++tick) {
    field.step(at(1e-3 * tick, 0.0, -depth), dt);
    double last = 0.0;
    for (const ElementEvent& event : field.events()) {
      EXPECT_GE(event.fraction, last);
      EXPECT_EQ(event.from, state);
      EXPECT_NE(event.to, state);
      last = event.fraction;
      state = event.to;
    }
    EXPECT_EQ(field.state(0), state);
    const ContactFrame& frame = labels.update({&field, 1}, tick * dt, dt);
    EXPECT_EQ(frame.unit_state[0], static_cast<UnitState>(static_cast<int>(state)));
    most = std::max(most, field.events().size());
  }
  EXPECT_GE(most, 3U);
}

TEST(InertiaLabels, ALiftedTipSlipsBeforeItSeparates) {
  // Lifted from d deep to d above in one step, k_n (d - 2 d s) at its share s, a tip that holds F =
  // k_t u slips where mu_s f_n = F, at s = (1 - F/(mu_s k_n d))/2, and separates at 1/2.
  const double mu = 0.5, u = 0.5e-3, dt = 1e-3;
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {{"inertia", {{"damping", 0.0}}}});
  for (const double x : {0.0, u, u}) field.step(at(x, 0.0, -depth), dt);
  ASSERT_EQ(field.state(0), ElementState::stick);
  field.step(at(u, 0.0, depth), dt);
  ASSERT_EQ(field.events().size(), 2U);
  EXPECT_EQ(field.events()[0].to, ElementState::slip);
  EXPECT_NEAR(field.events()[0].fraction, 0.5 * (1.0 - k_t * u / (mu * k_n * depth)), 1e-12);
  EXPECT_EQ(field.events()[1].to, ElementState::detached);
  EXPECT_NEAR(field.events()[1].fraction, 0.5, 1e-12);
}

TEST(InertiaRefusals, NamesWhatItCannotBeJoinedWith) {
  const auto refusal = [](const std::vector<std::string>& names, const PadLayout& pad, const Surface& surface) -> std::string {
    std::vector<Named> effects;
    for (const std::string& name : names) effects.push_back({name, defaults_of(kind_named(name).about.parameters)});
    return refusal_of<SceneValueError>([&] { install_effects(effects, pad, surface, 1, 0); });
  };
  const PadLayout pad = one_unit(k_n, k_t);
  EXPECT_THAT(refusal({"inertia", "anisotropic_friction"}, pad, Plane{}),
              refused_at("effects", {"inertia", "anisotropic_friction"}));
  EXPECT_THAT(refusal({"viscoelastic", "texture", "inertia"}, pad, Plane{}), refused_at("effects", {"inertia", "viscoelastic"}));
  EXPECT_THAT(refusal({"inertia", "viscous_friction"}, pad, Plane{}), refused_at("effects", {"inertia", "viscous_friction"}));
  EXPECT_THAT(refusal({"inertia"}, pad, Box{{1.0, 1.0, 1.0}}), refused_at("effects", {"inertia", "plane"}));
  PadLayout damped = pad;
  damped.elements.front().c_tangential = 1.0;
  EXPECT_THAT(refusal({"inertia"}, damped, Plane{}), refused_at("effects", {"inertia", "damping"}));
  EXPECT_THAT(refusal({"asperities"}, pad, Plane{}), refused_at("effects", {"asperities", "inertia"}));
  EXPECT_EQ(refusal({"asperities", "inertia", "roughness", "patchy_friction"}, pad, Plane{}), "accepted");
}

}  // namespace
}  // namespace slipbench::testing_effects::inertia_test
