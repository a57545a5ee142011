// The rate law of the slipping tip: mu_k g(w), g(w) = 1 + gain log10(1 + w/v0) = 1 + c ln y with c
// = gain/ln 10, y = 1 + w/v0.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "sim/core/random.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::viscous_friction_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0, depth = 1e-3, load = k_n * depth;

Wanted law(double gain, double speed) { return {"viscous_friction", {{"gain", gain}, {"speed", speed}}}; }
double growth(double gain, double speed, double w) { return 1.0 + gain * std::log10(1.0 + w / speed); }

TEST(ViscousFriction, SteadyForceAtAnySpeedAndStep) {
  // The tip of a steady slide moves at the root's speed v: f = mu_k g(v) f_n. 9 v0 is one decade,
  // 99 v0 two.
  const double mu_s = 0.6, mu_k = 0.5;
  for (const auto& [gain, speed] : {std::pair{0.2, 1e-3}, {0.08, 0.05e-3}, {1.0, 10e-3}}) {
    for (const double ratio : {1.0, 9.0, 99.0, 1e4}) {
      for (const double way : {1e-6, 10e-6, 200e-6}) {  // m per step
        Field field = field_with(one_unit(k_n, k_t), {mu_s, mu_k}, {law(gain, speed)});
        const double v = ratio * speed;
        for (int tick = 0; way * tick <= 30e-3; ++tick) field.step(at(way * tick, 0.0, -depth), way / v);
        const double exact = mu_k * growth(gain, speed, v) * load;
        EXPECT_NEAR(field.tangential_force(0).x(), exact, 1e-9 * exact) << "gain " << gain << ", v " << v << ", step " << way;
        EXPECT_NEAR(field.slip_step(0).x(), way, 1e-9 * way);
        EXPECT_NEAR(field.stick_limit(0), mu_s * load, 1e-15) << "static friction has no speed";
      }
    }
  }
}

TEST(ViscousFriction, EveryStepObeysTheLaw) {
  // For any parameters and motion: a slipping tip has f = mu_k f_n g(slip/dt) along the slip, and
  // never slips below mu_k f_n.
  RandomStream draw(1, 0, "rate law");
  int slid = 0;
  for (int field_number = 0; field_number < 60; ++field_number) {
    const auto decades = [&](double low, double high) { return std::pow(10.0, draw.uniform(low, high)); };
    const double gain = decades(-4.0, 1.0), speed = decades(-6.0, 0.0), dt = decades(-5.0, -1.0), mu = decades(-2.0, 0.3);
    Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {law(gain, speed)});
    double x = 0.0, y = 0.0;
    for (int tick = 0; tick < 200; ++tick) {
      const double step = decades(-8.0, -3.0), angle = draw.uniform(-2.0, 2.0);
      field.step(at(x += step * std::cos(angle), y += step * std::sin(angle), -depth), dt);
      const Eigen::Vector3d f = field.tangential_force(0), slip = field.slip_step(0);
      if (field.state(0) != ElementState::slip) {
        // Friction that is clearly beyond mu_s f_n never counts as stick, however slow the slip.
        ASSERT_LE(f.norm(), std::min(mu * load * growth(gain, speed, 1e-13 / dt), mu * load * (1.0 + 1e-6)) + 1e-10);
        continue;
      }
      ++slid;
      ASSERT_NEAR(f.norm(), mu * load * growth(gain, speed, slip.norm() / dt), 1e-7 * f.norm())
          << "gain " << gain << ", speed " << speed << ", dt " << dt << ", slip " << slip.norm();
      ASSERT_NEAR(f.dot(slip), f.norm() * slip.norm(), 1e-9 * f.norm() * slip.norm());
    }
  }
  EXPECT_GT(slid, 3000);
}

// Force of an element whose root moves at v from the start, after the tip began to slip: with F = L
// (1 + c ln y), k^-1 dF/dt = v - w(F) is the logistic equation y' = r y (1 + v/v0 - y), r = k v0/(c
// L).
double sliding_on(double t, double limit, double c, double v0, double v, double y0) {
  const double steady = 1.0 + v / v0, growing = std::exp(k_t * v0 / (c * limit) * steady * t);
  return limit * (1.0 + c * std::log(y0 * steady * growing / (steady + y0 * (growing - 1.0))));
}

TEST(ViscousFriction, OnsetAndApproachHaveTheirClosedForm) {
  // mu_s = mu_k: slip begins at L/(k v), without a jump (y = 1), and the force approaches L g(v).
  // Backward Euler of a contracting equation has an error of at most dt/2 times the integral of
  // |F''|, here dt/2 times the change of F', k v; the step of the onset adds k v dt.
  const double mu = 0.5, gain = 0.2, v0 = 1e-3, v = 9e-3, c = gain / std::numbers::ln10, limit = mu * load;
  std::vector<double> error;
  for (const double dt : {1e-4, 0.5e-4, 0.25e-4}) {
    Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {law(gain, v0)});
    const double onset = limit / (k_t * v);
    double worst = 0.0, before = 0.0;
    for (int tick = 0; tick * dt < onset + 0.05; ++tick) {
      field.step(at(v * dt * tick, 0.0, -depth), dt);
      for (const ElementEvent& event : field.events()) {
        if (event.to != ElementState::slip) continue;
        EXPECT_NEAR((tick - 1 + event.fraction) * dt, onset, 1e-12);
      }
      const double t = tick * dt - onset, force = field.tangential_force(0).x();
      worst = std::max(worst, std::abs(force - (t < 0.0 ? k_t * v * tick * dt : sliding_on(t, limit, c, v0, v, 1.0))));
      EXPECT_LE(force - before, k_t * v * dt * (1.0 + 1e-9)) << "never faster than the spring is stretched";
      before = force;
    }
    EXPECT_LT(worst, 1.5 * k_t * v * dt);
    error.push_back(worst);
  }
  EXPECT_LT(error[1], 0.6 * error[0]) << "first order";
  EXPECT_LT(error[2], 0.6 * error[1]);
}

TEST(ViscousFriction, HeldPadRelaxesByTheClosedForm) {
  // The root stops after a steady slide at v: k^-1 dF/dt = -w(F), the logistic equation with v = 0:
  // y = 1/(1 - (1 - 1/y0) exp(-r t)). The error of backward Euler is at most dt/2 times the change
  // of F': dt k v/2.
  const double mu = 0.5, gain = 0.2, v0 = 1e-3, v = 9e-3, c = gain / std::numbers::ln10, limit = mu * load;
  std::vector<double> error;
  for (const double dt : {1e-3, 0.5e-3, 0.25e-3}) {
    Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {law(gain, v0)});
    double x = 0.0;
    for (int tick = 0; tick * dt < 1.0; ++tick) field.step(at(x += v * dt, 0.0, -depth), dt);
    ASSERT_NEAR(field.tangential_force(0).x(), limit * growth(gain, v0, v), 1e-9);
    double worst = 0.0;
    for (int tick = 1; tick * dt <= 0.3; ++tick) {
      field.step(at(x, 0.0, -depth), dt);
      EXPECT_EQ(field.state(0), ElementState::slip) << "it creeps";
      const double exact = sliding_on(tick * dt, limit, c, v0, 0.0, 1.0 + v / v0);
      worst = std::max(worst, std::abs(field.tangential_force(0).x() - exact));
    }
    EXPECT_LT(worst, 0.5 * dt * k_t * v);
    error.push_back(worst);
  }
  for (const std::size_t finer : {1U, 2U}) EXPECT_NEAR(error[finer] / error[finer - 1], 0.5, 0.06) << "first order";
}

TEST(ViscousFriction, AFastGrowingLawNeverSticksBeyondTheStaticLimit) {
  // g(w) = 1 + 10 log10(1 + w/1e-9): within 1 ms a tip at w = 9e-11 m/s creeps 9e-14 m, less than
  // the rounding of coordinates, but carries 1.37 mu f_n. It slips, by the law, from mu_s f_n on.
  const double mu = 0.5, dt = 1e-3;
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {law(10.0, 1e-9)});
  int crept = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    // k_t x is 1.2 mu f_n after 1 s; then the pad is held.
    const double x = std::min(1e-3 * tick, 1.0) * 1.2 * mu * load / k_t, way = field.slip_path(0);
    field.step(at(x, 0.0, -depth), dt);
    const double force = field.tangential_force(0).norm();
    if (force > mu * load * (1.0 + 1e-5)) {
      ASSERT_EQ(field.state(0), ElementState::slip) << tick;
      ++crept;
    }
    ASSERT_GE(field.slip_path(0), way);
  }
  EXPECT_GT(crept, 3000);
}

TEST(ViscousFriction, CreepEndsOnceAndForGood) {
  // y - 1 falls as exp(-r t), r = k v0/(c L) = 13.8/s: after 2 s the creep of a step of 1 ms is
  // below 1e-18 m. The tip then sticks, at mu f_n, and does not slip again.
  const double mu = 0.5, dt = 1e-3;
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {law(0.2, 1e-3)});
  double x = 0.0;
  for (int tick = 0; tick < 500; ++tick) field.step(at(x += 10e-6, 0.0, -depth), dt);
  int stuck = 0, slipped = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    field.step(at(x, 0.0, -depth), dt);
    for (const ElementEvent& event : field.events()) (event.to == ElementState::stick ? stuck : slipped) += 1;
  }
  EXPECT_EQ(stuck, 1);
  EXPECT_EQ(slipped, 0);
  EXPECT_NEAR(field.tangential_force(0).x(), mu * load, 1e-8);
}

TEST(ViscousFriction, PartOfAUnitThatSlipsBearsMoreThanStaticFriction) {
  // Two bristles with the loads N_a = 0.5 N and N_b = 1.5 N on springs k = 300 N/m. At a slide of x
  // bristle a, which begins to slip at mu N_a/k = 0.83 mm, has come within 1e-7 of mu g N_a, g = 1
  // + 0.2 log10(1 + 9) = 1.2; b sticks up to mu N_b/k = 2.5 mm and carries k x. So the unit, which
  // slips in part, has the margin 1 - (mu g N_a + k x)/(mu (N_a + N_b)), below 0 from x = 2.33 mm
  // on, although no bristle has left its cone.
  const double mu = 0.5, g = 1.2, k = 300.0, light = 0.5, heavy = 1.5, v0 = 1e-3, v = 9e-3, dt = 1e-3;
  PadLayout pad = one_unit(1000.0, 2.0 * k, 2);
  pad.elements[0].k_normal = light / depth;
  pad.elements[1].k_normal = heavy / depth;
  Field field = field_with(pad, {mu, mu}, {law(0.2, v0)});
  ContactLabels labels(field.layout());
  double least = 1.0;
  for (int tick = 0; v * dt * tick < 2.49e-3; ++tick) {
    const double x = v * dt * tick;
    field.step(at(x, 0.0, -depth), dt);
    const ContactFrame& frame = labels.update({&field, 1}, tick * dt, dt);
    least = std::min(least, frame.margin[0]);
    if (x < 2e-3) continue;
    ASSERT_EQ(frame.unit_state[0], UnitState::partial) << x;
    EXPECT_NEAR(frame.margin[0], 1.0 - (mu * g * light + k * x) / (mu * (light + heavy)), 1e-7) << x;
    EXPECT_LE(field.tangential_force(1).norm(), mu * heavy);
  }
  EXPECT_LT(least, -0.04);
}

TEST(ViscousFriction, StaticFrictionIsALatch) {
  // mu_s > mu_k: slip begins at mu_s f_n, then follows mu_k g(w), even below mu_s: 0.45 (1 + 0.1
  // log10(2)) = 0.4635.
  const double mu_s = 0.6, mu_k = 0.45, v = 1e-3, dt = 1e-3;
  Field field = field_with(one_unit(k_n, k_t), {mu_s, mu_k}, {law(0.1, 1e-3)});
  double highest = 0.0, x = 0.0;
  int lets_go = 0;
  for (int tick = 0; tick < 3000; ++tick, x += v * dt) {
    field.step(at(x, 0.0, -depth), dt);
    highest = std::max(highest, field.tangential_force(0).x());
    for (const ElementEvent& event : field.events()) lets_go += event.to == ElementState::slip ? 1 : 0;
  }
  EXPECT_LE(highest, mu_s * load + 1e-12);
  EXPECT_GT(highest, mu_s * load - k_t * v * dt);
  EXPECT_EQ(lets_go, 1);
  EXPECT_NEAR(field.tangential_force(0).x(), mu_k * (1.0 + 0.1 * std::log10(2.0)) * load, 1e-9);
}

TEST(ViscousFriction, LightPlateDrivenByAForceSettlesAtItsTerminalSpeed) {
  // 20 g on 36 elements of 200 N/m, pulled by 1 N against mu N = 0.9 N: 0.9 g(v) = 1, v = v0
  // (10^((1/0.9 - 1)/gain) - 1) = 1.17 mm/s. The slope of friction there, L c/(v0 + v) = 26 N s/m,
  // over the mass times dt is 0.5; at v0 it would be 13. The plate is stepped as in MuJoCo.
  const double gain = 0.08, v0 = 0.05e-3, mass = 0.02, dt = 1.0 / 2400.0, indentation = 1e-3;
  PadLayout pad = one_unit(36.0 * 100.0, 36.0 * 200.0, 36);
  const double mu = 0.9 / (36.0 * 100.0 * indentation);
  Field field = field_with(pad, {mu, mu}, {law(gain, v0)});
  const double terminal = v0 * (std::pow(10.0, (1.0 / 0.9 - 1.0) / gain) - 1.0);
  double x = 0.0, v = 0.0, lowest = 1.0, highest = 0.0;
  for (int tick = 0; tick < 2400; ++tick) {
    field.step(at(x, 0.0, -indentation), dt);
    v += dt * (1.0 - field.wrench_on_surface().force.x()) / mass;
    x += dt * v;
    if (tick < 1200) continue;
    lowest = std::min(lowest, v);
    highest = std::max(highest, v);
    EXPECT_EQ(field.slipping(), 36U);
  }
  EXPECT_NEAR(lowest, terminal, 1e-9 * terminal);
  EXPECT_NEAR(highest, terminal, 1e-9 * terminal);
}

TEST(ViscousFriction, EllipticConeGrowsWithTheSpeedOfSlip) {
  // Associated flow on the ellipse of size L g(w): a steady slide along d at v has f = f_n g(v)
  // (mu_1^2 d_1, mu_2^2 d_2)/|(mu_1 d_1, mu_2 d_2)|.
  const double mu = 0.5, ratio = 0.6, gain = 0.2, v0 = 0.5e-3, v = 4e-3, dt = 1e-3;
  for (int eighth = 0; eighth < 8; ++eighth) {
    const double angle = eighth * std::numbers::pi / 4.0 + 0.2, d1 = std::cos(angle), d2 = std::sin(angle);
    Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {{"anisotropic_friction", {{"ratio", ratio}}}, law(gain, v0)});
    for (int tick = 0; tick < 10000; ++tick) field.step(at(v * dt * tick * d1, v * dt * tick * d2, -depth), dt);
    const double size = std::hypot(mu * d1, ratio * mu * d2), grown = growth(gain, v0, v);
    const Eigen::Vector3d exact = load * grown / size * Eigen::Vector3d(mu * mu * d1, ratio * mu * ratio * mu * d2, 0.0);
    EXPECT_NEAR((field.tangential_force(0) - exact).norm(), 0.0, 1e-9) << "angle " << angle;
    EXPECT_NEAR(field.cone_gauge(field.tangential_force(0), Eigen::Vector3d::UnitZ(), mu * load * grown), 1.0, 1e-9);
  }
}

TEST(ViscousFriction, MultipliesThePatchThatTheTipIsOn) {
  // mu_s = mu_k: stick_limit() is mu(x, y) f_n at that position, and a slipping tip carries g(w)
  // times that.
  const double dt = 1e-3, gain = 0.08, v0 = 0.05e-3;
  Field field = field_with(one_unit(k_n, k_t), {0.5, 0.5}, {law(gain, v0), {"patchy_friction", {{"sd", 0.3}}}});
  double least = 1.0, most = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    field.step(at(2e-6 * tick, 0.0, -depth), dt);
    if (field.state(0) != ElementState::slip) continue;
    const double w = field.slip_step(0).norm() / dt, limit = field.stick_limit(0);
    ASSERT_NEAR(field.tangential_force(0).norm(), limit * growth(gain, v0, w), 1e-9);
    least = std::min(least, limit);
    most = std::max(most, limit);
  }
  EXPECT_GT(most, 1.5 * least) << "it did cross patches";
}

}  // namespace
}  // namespace slipbench::testing_effects::viscous_friction_test
