// Oracle 6: the standard linear solid f = (1 - g) k u + q, q' = -q/tau + g k u'.
//   step u_0 at t = 0:          f = k u_0 ((1 - g) + g exp(-t/tau))                        relaxation
//   ramp u = v t:               f = k v ((1 - g) t + g tau (1 - exp(-t/tau)))
//   slip at constant f_t = F from t_1 (creep under load): the tip stops creeping over the surface; see the slide test

#include <gtest/gtest.h>

#include "tests/oracle/effect_field.h"
#include "tests/oracle/pads.h"

namespace slipbench::oracle::standard_linear_solid_test {
namespace {

constexpr double k_n = 7100.0, k_t = 3900.0, compression = 1e-3, g = 0.3, tau = 0.5;

Field viscoelastic_pad(double mu) {
  return field_with_effect(nine_pillars(), {mu, mu}, "viscoelastic", {{"relaxation", g}, {"time", tau}});
}

TEST(StandardLinearSolid, RelaxesAfterAStepExactlyAtAnyTimeStep) {
  for (const double dt : {1e-3, 1e-2, 0.1}) {
    Field field = viscoelastic_pad(0.5);
    drive(
        field, dt, 2.0,
        [](double) {
          return turned(0.0, {0.0, 0.0, -compression});
        },
        [&](const ContactFrame& frame) {
          const double exact = k_n * compression * ((1.0 - g) + g * std::exp(-frame.time / tau));
          EXPECT_NEAR(frame.force(2, 4), exact, 1e-12 * exact) << "t " << frame.time << ", dt " << dt;
        });
  }
}

TEST(StandardLinearSolid, ShearRampFollowsItsClosedFormToTheOnset) {
  // The normal force relaxes first, from the step on, as above; friction is high enough to prevent
  // slip.
  const double speed = 1e-3;
  Field field = viscoelastic_pad(5.0);
  drive(
      field, 1e-2, 1.0,
      [&](double t) {
        return turned(0.0, {speed * t, 0.0, -compression});
      },
      [&](const ContactFrame& frame) {
        const double t = frame.time;
        const double exact = k_t * speed * ((1.0 - g) * t + g * tau * (1.0 - std::exp(-t / tau)));
        EXPECT_NEAR(frame.force(0, 4), -exact, 1e-12 + 1e-12 * exact) << "t " << t;
        EXPECT_EQ(frame.unit_state[4], UnitState::stick);
      });
}

TEST(StandardLinearSolid, SlidingElementObeysTheConeOfItsRelaxedLoad) {
  const double mu = 0.4, speed = 8e-3;
  Field field = viscoelastic_pad(mu);
  int sliding = 0;
  drive(
      field, 1e-3, 2.0,
      [&](double t) {
        return turned(0.0, {speed * t, 0.0, -compression});
      },
      [&](const ContactFrame& frame) {
        if (frame.unit_state[4] != UnitState::slip) return;
        ++sliding;
        EXPECT_NEAR(-frame.force(0, 4), mu * frame.force(2, 4), 1e-12);
      });
  EXPECT_GT(sliding, 1000);
}

TEST(StandardLinearSolid, CreepsAtConstantForce) {
  // Creep at constant f = F: with the total compliance the stretch follows u(t) = F/k [1/(1-g) -
  // (g/(1-g)) exp(-(1-g) t/tau)] after a step of force. A slider at its limit is such a load: when
  // the pad slides fast past the limit (t small against tau) the stretch is F/k, from then on f_t =
  // mu f_n. f_n itself relaxes as in the first test, so F(t) = mu k_n delta ((1 - g) + g
  // exp(-t/tau)) and, for equal relaxation in both directions, u' = 0: q_t/f_t = q_n/f_n at all
  // times. The stretch stays mu k_n delta/k_t.
  const double mu = 0.1, speed = 50e-3;
  Field field = viscoelastic_pad(mu);
  const double stretch = mu * k_n * compression / k_t;  // 0.182 mm, reached after 3.6 ms = 0.007 tau
  double last = 0.0;
  drive(
      field, 1e-4, 1.0,
      [&](double t) {
        return turned(0.0, {speed * t, 0.0, -compression});
      },
      [&](const ContactFrame& frame) { last = -frame.displacement(0, 4); });
  // The ramp of 3.6 ms is not a step: its branch has relaxed for half of it on average, g t/(2 tau)
  // = 0.1 %, which decays after some tau.
  EXPECT_NEAR(last, stretch, 1.2e-3 * stretch);
}

}  // namespace
}  // namespace slipbench::oracle::standard_linear_solid_test
