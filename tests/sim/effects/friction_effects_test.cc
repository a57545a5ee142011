// Stribeck, load dependence and ageing against their laws, and combined friction effects.
#include <cmath>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "sim/contact/contact_labels.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::friction_effects_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0, depth = 1e-3, load = k_n * depth;

// Tangential force [N] after a slide of 5 mm at v, in steps of 10 um of travel.
double steady_force(Field& field, double v) {
  for (int tick = 0; tick <= 500; ++tick) field.step(at(10e-6 * tick, 0.0, -depth), 10e-6 / v);
  return field.wrench_on_surface().force.x();
}

// A pad that rolls about X at w while it moves along Y at u: its root, r below the pad's origin, has
// the speed u + w r cos(w t). The pad's motion is given, so no difference of positions is taken.
TEST(Stribeck, SpeedOfARollingPadIsThatOfItsRoot) {
  constexpr double r = 10e-3, w = 1.0, u = 4e-3, mu_k = 0.5, weakening = 0.4, speed = 5e-3, dt = 1e-3;
  PadLayout pad = one_unit(k_n, k_t);
  pad.elements[0].tip.z() = -r;
  Field field = field_with(pad, {0.6, mu_k}, {{"stribeck", {{"weakening", weakening}, {"speed", speed}, {"exponent", 1.0}}}});
  double angle = 0.0;
  for (int tick = 0; tick <= 200; ++tick) {
    const double t = tick * dt;
    angle = w * t;
    Pose pose = at(0.0, u * t, r * std::cos(angle) - depth);
    pose.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Twist motion{{0.0, u, -w * r * std::sin(angle)}, {w, 0.0, 0.0}};
    field.step(pose, dt, &motion);
  }
  ASSERT_EQ(field.state(0), ElementState::slip) << "2.8 mm of travel, of which 0.5 N / 600 N/m = 0.8 mm stretch the element";
  const double v = u + w * r * std::cos(angle), exact = mu_k * (1.0 - weakening * (1.0 - std::exp(-v / speed))) * load;
  EXPECT_NEAR(field.tangential_force(0).norm(), exact, 1e-9 * exact);
}

// growth(v) is the relative slope of factor(v).
TEST(ViscousFriction, GrowthIsTheSlopeOfTheFactor) {
  const FieldEffects effects = installed(one_unit(k_n, k_t), {{"viscous_friction", {{"gain", 0.3}, {"speed", 1e-3}}}});
  for (const double v : {0.0, 1e-3, 20e-3}) {
    // The error of a central difference is about (h/speed)^2, that of rounding 1e-16 speed/h.
    const double h = 1e-8, slope = (effects.rate->factor(v + h) - effects.rate->factor(v - h)) / (2.0 * h);
    EXPECT_NEAR(effects.rate->growth(v), slope / effects.rate->factor(v), 1e-6 * effects.rate->growth(v)) << v;
  }
}

TEST(Stribeck, SteadyForceAtAnySpeed) {
  // mu_k(v) = mu_k (1 - w (1 - exp(-(v/v_s)^p)))
  const double mu_s = 0.6, mu_k = 0.5, weakening = 0.4, speed = 2e-3;
  for (const double exponent : {0.5, 1.0, 2.0}) {
    for (const double v : {0.1e-3, 2e-3, 5e-3, 50e-3}) {
      Field field = field_with(one_unit(k_n, k_t), {mu_s, mu_k},
                               {{"stribeck", {{"weakening", weakening}, {"speed", speed}, {"exponent", exponent}}}});
      const double exact = mu_k * (1.0 - weakening * (1.0 - std::exp(-std::pow(v / speed, exponent)))) * load;
      EXPECT_NEAR(steady_force(field, v), exact, 1e-11 * exact) << "v " << v << ", exponent " << exponent;
      EXPECT_NEAR(field.stick_limit(0), mu_s * load, 1e-15) << "static friction does not weaken";
    }
  }
}

TEST(LoadDependence, SteadyForceFollowsThePowerOfTheLoad) {
  // f_t = mu (f_n/reference)^(-1/3) f_n
  const double mu = 0.5, reference = 2.0;
  for (const double indentation : {0.01e-3, 0.3e-3, 2e-3}) {
    const double f_n = k_n * indentation;
    Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {{"load_dependent_friction", {{"reference", reference}}}});
    for (int tick = 0; tick <= 500; ++tick) field.step(at(20e-6 * tick, 0.0, -indentation), 1e-3);
    const double exact = mu * std::pow(f_n / reference, -1.0 / 3.0) * f_n;
    EXPECT_NEAR(field.wrench_on_surface().force.x(), exact, 1e-12 * exact);
  }
}

TEST(LoadDependence, EqualBristlesBehaveAsOneElement) {
  const double mu = 0.5, v = 4e-3, dt = 1e-3;
  std::vector<double> onset, force;
  for (const std::size_t bristles : {1U, 4U}) {
    Field field = field_with(one_unit(k_n, k_t, bristles), {mu, mu}, {{"load_dependent_friction", {}}});
    ContactLabels labels(field.layout());
    for (int tick = 0; tick <= 500; ++tick) {
      field.step(at(v * tick * dt, 0.0, -depth), dt);
      for (const ContactEvent& event : labels.update({&field, 1}, tick * dt, dt).events) {
        if (event.kind == EventKind::slip) onset.push_back(event.time);
      }
    }
    force.push_back(labels.frame().force(0, 0));
  }
  // At 1 N, the reference, mu is the scene's: onset at mu f_n/(k_t v).
  ASSERT_EQ(onset.size(), 2U);
  EXPECT_NEAR(onset[0], mu * load / (k_t * v), 1e-12);
  EXPECT_NEAR(onset[1], onset[0], 1e-12);
  EXPECT_NEAR(force[0], -mu * load, 1e-12);
  EXPECT_NEAR(force[1], force[0], 1e-12);
}

TEST(Ageing, StaticFrictionGrowsWithTheLogarithmOfTheWait) {
  // Stuck since t = 0 and dragged at v from t = wait on: slip at the T that solves k_t v T = mu_s
  // (1 + r ln(1 + (wait + T)/tau)) f_n. The field takes the limit as linear within a step; its
  // error is at most dt^2/8 of the second derivative, mu_s f_n r/tau^2. Divided by the slope k_t v
  // minus the limit's own, that is under 1e-3 x 0.5 N x 0.05/(0.1 s)^2 x 1e-6 s^2/8 / (2.4 - 0.25)
  // N/s = 1.5e-7 s for dt = 1 ms.
  const double mu_s = 0.5, mu_k = 0.3, rate = 0.05, tau = 0.1, v = 4e-3, dt = 1e-3;
  for (const double wait : {0.0, 0.1, 1.0, 10.0}) {
    double exact = mu_s * load / (k_t * v);
    for (int k = 0; k < 100; ++k) exact = mu_s * load * (1.0 + rate * std::log1p((wait + exact) / tau)) / (k_t * v);
    Field field = field_with(one_unit(k_n, k_t), {mu_s, mu_k}, {{"ageing", {{"rate", rate}, {"time", tau}}}});
    const int waiting = static_cast<int>(std::lround(wait / dt));
    double onset = 0.0;
    for (int tick = 0; tick < waiting + 500; ++tick) {
      field.step(at(std::max(0, tick - waiting) * dt * v, 0.0, -depth), dt);
      if (onset == 0.0 && field.state(0) == ElementState::slip) onset = (tick - waiting - 1 + field.events()[0].fraction) * dt;
    }
    EXPECT_NEAR(onset, exact, 2e-7) << "wait " << wait;
    EXPECT_NEAR(field.tangential_force(0).x(), mu_k * load, 1e-12) << "kinetic friction does not age";
    EXPECT_NEAR(field.stick_limit(0), mu_s * load, 1e-15) << "slip makes it young again";
  }
}

TEST(AnisotropicFriction, GrainLiesHorizontallyOnTheSideFacesOfABox) {
  // The grain's projection onto the face does so at any angle, and also where the grain is
  // perpendicular to the face and has no projection (0 and 180 deg on x, 90 deg on y). A steady
  // slide along the grain has mu f_n, one across it ratio mu f_n.
  const double mu = 0.5, ratio = 0.6;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const double angle : {0.0, 1e-9, 0.7, 0.5 * std::numbers::pi, std::numbers::pi}) {
    for (const Eigen::Vector3d& n : {Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Vector3d(-1.0, 0.0, 0.0),
                                     Eigen::Vector3d(0.0, 1.0, 0.0), Eigen::Vector3d(0.0, -1.0, 0.0)}) {
      const Eigen::Vector3d level = up.cross(n);
      for (const auto& [way, friction] : {std::pair{level, mu}, std::pair{up, ratio * mu}}) {
        const PadLayout pad = one_unit(k_n, k_t);
        Field field(pad, Box{{20e-3, 20e-3, 20e-3}}, {mu, mu},
                    installed(pad, {{"anisotropic_friction", {{"ratio", ratio}, {"angle", angle}}}}));
        Pose pose;
        pose.rotation << level, n.cross(level), n;  // the element's axis, -Z of the pad, points at the face
        for (int tick = 0; tick <= 200; ++tick) {
          pose.position = (20e-3 - depth) * n + 10e-6 * tick * way;
          field.step(pose, 1e-3);
        }
        EXPECT_EQ(field.state(0), ElementState::slip);
        EXPECT_NEAR((field.tangential_force(0) - friction * load * way).norm(), 0.0, 1e-9)
            << "angle " << angle << ", face " << n.transpose() << ", way " << way.transpose();
        EXPECT_NEAR(field.cone_gauge(field.tangential_force(0), n, mu * load), 1.0, 1e-9);
      }
    }
  }
}

TEST(FrictionEffects, TwoOfThemMultiply) {
  const Friction friction{0.5, 0.4};
  const PadLayout pad = one_unit(k_n, k_t);
  const Wanted patchy{"patchy_friction", {}}, heavy{"load_dependent_friction", {{"reference", 0.2}}};
  Field plain(pad, Plane{}, friction);
  Field first = field_with(pad, friction, {patchy}), second = field_with(pad, friction, {heavy});
  Field both = field_with(pad, friction, {patchy, heavy}), swapped = field_with(pad, friction, {heavy, patchy});
  for (Field* field : {&plain, &first, &second, &both, &swapped}) field->step(at(1.3e-3, 0.7e-3, -depth), 1e-3);
  const double factor_first = first.stick_limit(0) / plain.stick_limit(0),
               factor_second = second.stick_limit(0) / plain.stick_limit(0);
  EXPECT_NEAR(factor_second, std::cbrt(0.2), 1e-12);  // 1 N against 0.2 N, to the power -1/3
  EXPECT_NE(factor_first, 1.0);
  EXPECT_NEAR(both.stick_limit(0), plain.stick_limit(0) * factor_first * factor_second, 1e-12);
  EXPECT_NEAR(swapped.stick_limit(0), both.stick_limit(0), 1e-12);
}

}  // namespace
}  // namespace slipbench::testing_effects::friction_effects_test
