// Oracles 5 and 9: tips with mass against closed forms of a driven and a free oscillator with
// Coulomb friction.
#include <numbers>

#include <gtest/gtest.h>

#include "sim/core/random.h"
#include "sim/effects/stick_slip.h"
#include "tests/oracle/effect_field.h"
#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::oracle::inertia_test {
namespace {

constexpr double pi = std::numbers::pi, k_n = 1000.0, k_t = 300.0, depth = 1e-3, load = k_n * depth, frequency = 180.0;

Field element_with_mass(Friction friction, double f, double damping) {
  return field_with_effect(testing_field::one_element(k_n, k_t), friction, "inertia",
                           {{"frequency", f}, {"damping", damping}, {"scatter", 0.0}});
}

struct Change {
  double time;
  ElementState to;
};

// Steps through `root(t)` [m] at the pressed depth; reports every change, and the field after every
// step.
std::vector<Change> slide(Field& field, double dt, double duration, const std::function<Eigen::Vector2d(double)>& root,
                          const std::function<void(double)>& look = {}) {
  std::vector<Change> changes;
  const auto ticks = static_cast<int>(std::lround(duration / dt));
  for (int tick = 0; tick <= ticks; ++tick) {
    const double time = tick * dt;
    const Eigen::Vector2d at = root(time);
    field.step(turned(0.0, {at.x(), at.y(), -depth}), dt);
    for (const ElementEvent& event : field.events()) changes.push_back({time - (1.0 - event.fraction) * dt, event.to});
    field.view_from_pad();
    if (look) look(time);
  }
  return changes;
}

TEST(Inertia, AReleasedTipRingsAtItsFrequencyAndFadesAtAnyStep) {
  // Lifted off, the tip swings freely about a fixed root: u = exp(-s t) cos(w t + p), s = zeta
  // omega, w = omega sqrt(1 - zeta^2). Its samples obey u[n+2] = 2 exp(-s dt) cos(w dt) u[n+1] -
  // exp(-2 s dt) u[n] for any dt, and no other frequency or decay does (below half the sampling
  // rate).
  for (const double zeta : {0.0, 0.06, 0.7}) {
    for (const double dt : {1e-4, 1e-3, 2.7e-3}) {
      Field field = element_with_mass({0.5, 0.5}, frequency, zeta);
      for (const double x : {0.0, 0.5e-3, 0.5e-3}) field.step(turned(0.0, {x, 0.0, -depth}), 1.0);  // stretched, at rest
      ASSERT_EQ(field.state(0), ElementState::stick);
      std::vector<double> u;
      for (int n = 0; n < 40; ++n) {
        field.step(turned(0.0, {0.5e-3, 0.0, depth}), dt);
        EXPECT_EQ(field.state(0), ElementState::detached);
        u.push_back(field.stretch(0).x());
      }
      const double omega = 2.0 * pi * frequency, fade = std::exp(-zeta * omega * dt);
      const double turn = std::cos(omega * std::sqrt(1.0 - zeta * zeta) * dt);
      EXPECT_GT(std::abs(u[0]), 1e-6);
      for (std::size_t n = 0; n + 2 < u.size(); ++n) {
        EXPECT_NEAR(u[n + 2], 2.0 * fade * turn * u[n + 1] - fade * fade * u[n], 1e-15) << "zeta " << zeta << ", dt " << dt;
      }
    }
  }
}

TEST(Inertia, AFreeTipIsFeltAndTouchesNothing) {
  Field field = element_with_mass({0.5, 0.5}, frequency, 0.0);
  for (const double x : {0.0, 0.5e-3, 0.5e-3}) field.step(turned(0.0, {x, 0.0, -depth}), 1.0);
  double largest = 0.0;
  for (int n = 0; n < 200; ++n) {
    field.step(turned(0.0, {0.5e-3, 0.0, depth}), 1e-4);
    field.view_from_pad();
    EXPECT_EQ(field.tangential_force(0).norm(), 0.0);
    EXPECT_DOUBLE_EQ(field.force_on_pad(0).x(), -k_t * field.stretch(0).x());
    largest = std::max(largest, std::abs(field.force_on_pad(0).x()));
  }
  // It was released halfway through the first step, at k u, and has lost nothing since.
  EXPECT_NEAR(largest, k_t * 0.5e-3, 0.01 * k_t * 0.5e-3);
}

TEST(Inertia, StickSlipHasThePeriodAndTheDropOfTheDrivenOscillator) {
  // No damping. While the tip sticks, the force grows by k v until mu_s N. Then d = u - mu_k N/k
  // starts at D = (mu_s - mu_k) N/k with the rate v, and d = D cos(omega t) + v/omega sin(omega t).
  // The tip stops when d' = v: with h = omega t/2,
  //   v (1 - cos 2h) + D omega sin 2h = 0,  tan h = -D omega/v,  t = 2 (pi - atan(D omega/v))/omega,
  // where d = -D: the force has fallen by 2 (mu_s - mu_k) N, and takes 2 D/v to recover.
  const double omega = 2.0 * pi * frequency;
  for (const Friction friction : {Friction{0.6, 0.5}, Friction{0.6, 0.4}, Friction{0.3, 0.0}}) {
    const double gap = (friction.mu_static - friction.mu_kinetic) * load / k_t;
    for (const double speed : {3e-3, 33e-3, 0.3}) {
      const double slips = 2.0 * (pi - std::atan(gap * omega / speed)) / omega, sticks = 2.0 * gap / speed;
      for (const double dt : {1e-4, 1e-3, 7e-3}) {
        Field field = element_with_mass(friction, frequency, 0.0);
        const double first = friction.mu_static * load / (k_t * speed);
        const auto changes = slide(field, dt, std::ceil((first + 20.5 * (slips + sticks)) / dt) * dt,
                                   [&](double t) { return Eigen::Vector2d(speed * t, 0.0); });
        ASSERT_GT(changes.size(), 40U);
        ASSERT_EQ(changes[0].to, ElementState::stick);  // placed
        double expected = first;
        for (std::size_t n = 1; n <= 40; ++n) {
          ASSERT_EQ(changes[n].to, n % 2 == 1 ? ElementState::slip : ElementState::stick);
          ASSERT_NEAR(changes[n].time, expected, 1e-9 * (slips + sticks) * static_cast<double>(n))
              << "change " << n << ", dt " << dt;
          expected += n % 2 == 1 ? slips : sticks;
        }
      }
    }
  }
}

TEST(Inertia, StickSlipForceSwingsAboutKineticFrictionByItsExcess) {
  // As above: the felt force runs from mu_s N down to (2 mu_k - mu_s) N and, in slip, exceeds mu_k
  // N by at most sqrt(D^2 + (v/omega)^2).
  const Friction friction{0.6, 0.45};
  const double omega = 2.0 * pi * frequency, speed = 10e-3, dt = 1e-5;
  const double gap = (friction.mu_static - friction.mu_kinetic) * load / k_t, swing = k_t * std::hypot(gap, speed / omega);
  Field field = element_with_mass(friction, frequency, 0.0);
  double least = load, most = 0.0;
  slide(
      field, dt, 1.0, [&](double t) { return Eigen::Vector2d(0.0, -speed * t); },
      [&](double time) {
        const double felt = field.force_on_pad(0).y();
        if (time > 0.5) least = std::min(least, felt);
        most = std::max(most, felt);
        EXPECT_LE(field.tangential_force(0).norm(), friction.mu_static * load + k_t * 2e-13);
        if (field.state(0) == ElementState::slip) {
          EXPECT_NEAR(field.tangential_force(0).y(), -friction.mu_kinetic * load, 1e-12);
        }
      });
  // Within a step the force changes by at most k (v + swing omega/k) dt.
  const double resolved = (k_t * speed + swing * omega) * dt;
  EXPECT_NEAR(least, friction.mu_kinetic * load - swing, resolved);
  EXPECT_NEAR(most, friction.mu_kinetic * load + swing, resolved);
}

TEST(Inertia, AStuckElementHasNothingButTheRamp) {
  // k v t + c v, c = 2 zeta k/omega.
  const double zeta = 0.1, speed = 1e-3, c = 2.0 * zeta * k_t / (2.0 * pi * frequency);
  Field field = element_with_mass({2.0, 1.5}, frequency, zeta);
  slide(
      field, 1e-4, 0.3, [&](double t) { return Eigen::Vector2d(speed * t, 0.0); },
      [&](double time) {
        if (time > 0.0) {
          EXPECT_NEAR(field.force_on_pad(0).x(), -(k_t * speed * time + c * speed), 1e-12);
        }
        EXPECT_EQ(field.slip_path(0), 0.0);
      });
}

TEST(Inertia, WithoutMassItIsTheMasslessField) {
  // Critically damped, so that the tip does not swing back and stick: the latch. The dashpot
  // relaxes with the mass: the onset is early by c/k = 2 zeta/omega. Afterwards u settles at mu_k
  // N/k, so from a few 1/omega on the path is that of the massless tip, v t - mu_k N/k.
  const Friction friction{0.6, 0.4};
  const double speed = 4e-3;
  for (const double f : {200.0, 2e3, 2e4}) {
    const double omega = 2.0 * pi * f;
    Field field = element_with_mass(friction, f, 1.0);
    const auto changes = slide(field, 1e-3, 1.0, [&](double t) { return Eigen::Vector2d(speed * t, 0.0); });
    ASSERT_EQ(changes.size(), 2U);
    EXPECT_NEAR(changes[1].time, friction.mu_static * load / (k_t * speed) - 2.0 / omega, 1e-9);
    EXPECT_EQ(changes[1].to, ElementState::slip);
    EXPECT_NEAR(field.slip_path(0), speed - friction.mu_kinetic * load / k_t, 1e-12);
    EXPECT_NEAR(field.force_on_pad(0).x(), -friction.mu_kinetic * load, 1e-9);
  }
}

TEST(Inertia, SlowLoadingLetsGoWhereTheMasslessTipDoes) {
  // k v t + c v = mu_s N: early by c/k = 2 zeta/omega at any speed, so the force at the onset
  // approaches mu_s N as v goes to zero.
  for (const double speed : {10e-3, 1e-3, 1e-4}) {
    const double exact = 0.5 * load / (k_t * speed), dt = exact / 100.3;
    Field field = element_with_mass({0.5, 0.5}, frequency, 0.1);
    const auto changes = slide(field, dt, 110.0 * dt, [&](double t) { return Eigen::Vector2d(speed * t, 0.0); });
    ASSERT_GE(changes.size(), 2U);
    EXPECT_NEAR(changes[1].time, exact - 0.2 / (2.0 * pi * frequency), 1e-9 * exact);
  }
}

TEST(Inertia, AllDirectionsAreAlike) {
  // A curved path turned by an angle: all forces turn with it.
  const auto way = [](double t) { return Eigen::Vector2d(8e-3 * t + 1e-4 * std::sin(70.0 * t), 2e-4 * std::sin(40.0 * t)); };
  Field straight = element_with_mass({0.6, 0.4}, frequency, 0.08);
  std::vector<Eigen::Vector3d> forces;
  slide(straight, 1e-4, 0.3, way, [&](double) { forces.push_back(straight.force_on_pad(0)); });
  for (const double angle : {0.5, pi / 2.0, 4.0}) {
    Field field = element_with_mass({0.6, 0.4}, frequency, 0.08);
    std::size_t tick = 0;
    const Eigen::Rotation2Dd turn(angle);
    slide(
        field, 1e-4, 0.3, [&](double t) { return turn * way(t); },
        [&](double) {
          const Eigen::Vector2d force = turn * forces[tick].head<2>();
          // Rounding, 1e-16 of the coordinates, is multiplied in every stick-slip cycle by the
          // slope of the cycle's map, which is below one here.
          EXPECT_NEAR((field.force_on_pad(0).head<2>() - force).norm(), 0.0, 1e-8) << "angle " << angle << ", tick " << tick;
          ++tick;
        });
  }
}

// Energy of the tip [J].
double energy(const TipLaw& law, const Tip& tip) {
  const double omega = law.oscillator.omega, mass = law.k / (omega * omega);
  return 0.5 * (mass * tip.speed.squaredNorm() + law.k * tip.place.squaredNorm());
}

TEST(Inertia, FrictionNeverDrivesATip) {
  // The root is fixed at the origin, so only the tip's own energy moves the tip. The energy never
  // grows, in either direction and at any step, up to rounding; and friction stops the tip.
  RandomStream draw(5, 0, "tips");
  for (int trial = 0; trial < 300; ++trial) {
    const TipLaw law{k_t, {2.0 * pi * draw.uniform(20.0, 2e3), draw.uniform(0.0, 1.5)}};
    const double dt = std::pow(10.0, draw.uniform(-5.0, -2.0)), f_n = draw.uniform(0.1, 1.0), mu = draw.uniform(0.05, 1.0);
    const TipDrive drive{
        {0.0, 0.0}, {0.0, 0.0}, dt, {f_n, f_n}, {1.1 * mu * f_n, 1.1 * mu * f_n}, mu, 0.3 / (law.oscillator.omega * dt)};
    const double reach = 5.0 * f_n / k_t;
    Tip tip{{draw.normal(0.0, reach), draw.normal(0.0, reach)},
            law.oscillator.omega * Eigen::Vector2d(draw.normal(0.0, reach), draw.normal(0.0, reach)),
            ElementState::slip};
    const double start = energy(law, tip);
    std::vector<ElementEvent> events;
    double before = start;
    int steps = 0;
    // Friction reduces the amplitude by 2 mu f_n/k per half swing, from some 10 times the friction
    // limit.
    for (; tip.state == ElementState::slip && steps < 1e7; ++steps) {
      TipTrace trace;
      move_tip(law, drive, 0, tip, trace, events);
      ASSERT_LE(energy(law, tip), before + 1e-14 * start) << "trial " << trial << ", step " << steps;
      before = energy(law, tip);
    }
    ASSERT_EQ(tip.state, ElementState::stick) << "trial " << trial;
    EXPECT_LE(law.k * tip.place.norm(), 1.1 * mu * f_n * (1.0 + 1e-9));
    EXPECT_EQ(events.size(), 1U) << "trial " << trial;
  }
}

}  // namespace
}  // namespace slipbench::oracle::inertia_test
