// Columns that lean: V = k_n (d - q^2/2L)^2/2 + k_t q^2/2 + k_s max(0, q - q_b)^2/2; forces are its
// derivatives.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>

#include "sim/effects/install.h"
#include "tests/expect.h"
#include "tests/sim/contact/random_case.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::lean_test {
namespace {

constexpr double k_n = 830.0, k_t = 200.0, length = 3.65e-3, stop = 0.55e-3, k_s = 1000.0;
const Wanted leaning{"lean", {{"length", length}, {"stop", stop}, {"stop_stiffness", k_s}}};
constexpr double shallow = 0.3e-3, deep = 1.5e-3;  // 0.25 N and 1.25 N upright; the buckling load k_t L is 0.73 N

double load(double d, double q) { return k_n * (d - q * q / (2.0 * length)); }
double shear(double d, double q) { return k_t * q - load(d, q) * q / length + k_s * std::max(0.0, q - stop); }
double potential(double d, double q) {
  const double beyond = std::max(0.0, q - stop);
  return 0.5 * load(d, q) * load(d, q) / k_n + 0.5 * k_t * q * q + 0.5 * k_s * beyond * beyond;
}

// Returns the root of `f` between a and b.
template <class F>
double root(F f, double a, double b) {
  for (int bit = 0; bit < 100; ++bit) {
    const double middle = 0.5 * (a + b);
    ((f(middle) > 0.0) == (f(a) > 0.0) ? a : b) = middle;
  }
  return a;
}

TEST(Lean, StuckTipMeetsTheClosedFormBelowAndAboveBuckling) {
  for (const double d : {shallow, deep}) {
    for (const double angle : {0.0, 1.1, 4.0}) {
      Field field = field_with(one_unit(k_n, k_t), {9.0, 9.0}, {leaning});
      field.step(at(0.0, 0.0, -d), 1e-3);
      for (int step = 1; step <= 100; ++step) {
        const double q = (d == deep ? 12e-6 : 6e-6) * step;
        field.step(at(q * std::cos(angle), q * std::sin(angle), -d), 1e-3);
        ASSERT_EQ(field.state(0), ElementState::stick);
        EXPECT_NEAR(field.normal_force(0), load(d, q), 1e-12);
        EXPECT_NEAR(field.tangential_force(0).x(), shear(d, q) * std::cos(angle), 1e-12);
        EXPECT_NEAR(field.tangential_force(0).y(), shear(d, q) * std::sin(angle), 1e-12);
      }
    }
  }
  EXPECT_GT(shear(shallow, 0.1e-3), 0.0) << "0.25 N: softer";
  EXPECT_LT(shear(deep, 0.1e-3), 0.0) << "1.25 N: it pushes on outwards, up to the stop";
  EXPECT_GT(shear(deep, 0.8e-3), 0.0);
}

TEST(Lean, GivesNoWorkInAClosedLoop) {
  // Twice round a loop without slip, through the buckling load and through the stop: the work done
  // on the pad equals the potential's loss at every point, and zero after a turn. The trapezoid of
  // 20,000 chords per turn has an error of (2 pi/20,000)^2 of the energies, about 1e-7.
  Field field = field_with(one_unit(k_n, k_t), {9.0, 9.0}, {leaning});
  const Eigen::Vector3d start(0.0, 0.0, -1e-3);
  field.step(at(start.x(), start.y(), start.z()), 1e-3);
  Eigen::Vector3d before = start, force = field.wrench_on_pad().force;
  const int chords = 20000;
  double work = 0.0, largest = 0.0, at_the_start = 0.0;
  for (int k = -1000; k <= 2 * chords; ++k) {
    const double phase = 2.0 * std::numbers::pi * std::max(k, 0) / chords, onto_the_loop = std::min(1.0, (k + 1000) / 1000.0);
    const Eigen::Vector3d on_loop(0.9e-3 * std::sin(phase), 0.4e-3 * std::sin(2.0 * phase + 0.3),
                                  -1.1e-3 + 0.4e-3 * std::cos(phase));
    const Eigen::Vector3d now = start + onto_the_loop * (on_loop - start);
    field.step(at(now.x(), now.y(), now.z()), 1e-3);
    ASSERT_EQ(field.state(0), ElementState::stick) << k;
    const Eigen::Vector3d acts = field.wrench_on_pad().force;
    work += 0.5 * (acts + force).dot(now - before);
    const double held = potential(-now.z(), std::hypot(now.x(), now.y()));
    ASSERT_NEAR(work, potential(1e-3, 0.0) - held, 2e-9) << k;
    largest = std::max(largest, held);
    if (k == 0) at_the_start = work;
    before = now;
    force = acts;
  }
  EXPECT_NEAR(work, at_the_start, 1e-9);
  EXPECT_GT(largest, 5e-4) << "J, which the tolerance is to be measured by";
}

TEST(Lean, SteadySlideHasTheRootOfItsLaw) {
  // f_t(q) = mu f_n(q), with the column dragged behind its root.
  const double mu = 0.6;
  for (const auto& [d, low, high] : {std::tuple{shallow, 0.0, 0.9e-3}, std::tuple{deep, stop, 2.0e-3}}) {
    const double depth = d;
    const double q = root([&](double x) { return shear(depth, x) - mu * load(depth, x); }, low, high);
    Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {leaning});
    for (int tick = 0; tick <= 3000; ++tick) field.step(at(2e-6 * tick, 0.0, -d), 1e-3);
    ASSERT_EQ(field.state(0), ElementState::slip);
    EXPECT_NEAR(field.stretch(0).x(), q, 1e-9 * q);
    EXPECT_NEAR(field.normal_force(0), load(d, q), 1e-9);
    EXPECT_NEAR(field.tangential_force(0).x(), mu * load(d, q), 1e-9);
    EXPECT_NEAR(field.slip_step(0).x(), 2e-6, 1e-14);
  }
}

TEST(Lean, LetsGoWhereTheConeIsReached) {
  // Slip begins at the q of f_t(q) = mu f_n(q). Force and limit are linear within a step: second
  // order in the 2 um of a step.
  const double mu = 0.6;
  const double q = root([&](double x) { return shear(shallow, x) - mu * load(shallow, x); }, 0.0, 0.9e-3);
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {leaning});
  double onset = 0.0;
  for (int tick = 0; onset == 0.0 && tick < 2000; ++tick) {
    field.step(at(2e-6 * tick, 0.0, -shallow), 1e-3);
    for (const ElementEvent& event : field.events()) {
      if (event.to == ElementState::slip) onset = 2e-6 * (tick - 1 + event.fraction);
    }
  }
  EXPECT_NEAR(onset, q, 2e-9);
}

TEST(Lean, SnapsOutwardsToItsStopWhereFrictionIsLow) {
  // mu < stop/L: beyond buckling |f_t| = (f_n/L - k_t) q reaches mu f_n before the stop. The tip
  // moves outwards, away from its root, until f_t(q) = -mu f_n(q) in the stop; slip releases no
  // energy. Dragged on, it sticks, then follows at f_t = mu f_n.
  const double mu = 0.05, d = deep, step = 1e-6;
  const auto outwards = [&](double q) { return -shear(d, q) - mu * load(d, q); };
  const double lets_go = root(outwards, 0.1e-3, stop), rests = root(outwards, stop, 0.8e-3);
  const double follows = root([&](double q) { return shear(d, q) - mu * load(d, q); }, stop, 0.9e-3);
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {leaning});
  double snapped = 0.0;
  for (int tick = 0; tick <= 2000; ++tick) {
    field.step(at(step * tick, 0.0, -d), 1e-3);
    const double gives = field.tangential_force(0).dot(field.slip_step(0));
    EXPECT_GE(gives, 0.0);
    if (!(field.slip_step(0).norm() > 10e-6)) continue;
    EXPECT_EQ(snapped, 0.0) << "once";
    snapped = step * tick;
    EXPECT_NEAR(field.stretch(0).x(), rests, 1e-9);
    EXPECT_NEAR(field.slip_step(0).x(), -(rests - snapped), 1e-9);
    EXPECT_NEAR(field.tangential_force(0).x(), -mu * load(d, rests), 1e-9);
    EXPECT_GT(potential(d, snapped) - potential(d, rests), gives);
  }
  EXPECT_NEAR(snapped, lets_go, step);
  EXPECT_NEAR(field.stretch(0).x(), follows, 1e-9);
  EXPECT_NEAR(field.tangential_force(0).x(), mu * load(d, follows), 1e-9);
}

TEST(Lean, UnloadedWhileItLeansItSlidesHome) {
  // d falls to 0 with the root 0.2 mm aside: f_n = 0 at q = sqrt(2 L d) would leave a bent column
  // in the air. The cone brings the tip back before that: it presses until d = 0, then stands
  // upright.
  const double mu = 0.8;
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {leaning});
  field.step(at(0.0, 0.0, -shallow), 1e-3);
  field.step(at(0.2e-3, 0.0, -shallow), 1e-3);
  for (int tick = 0; tick < 300; ++tick) {
    field.step(at(0.2e-3, 0.0, -shallow * (1.0 - tick / 300.0)), 1e-3);
    ASSERT_GT(field.normal_force(0), 0.0) << tick;
    ASSERT_LE(field.tangential_force(0).norm(), mu * field.normal_force(0) + 1e-12) << tick;
  }
  EXPECT_LT(field.stretch(0).norm(), 5e-6) << "mu f_n/k_t at 0.83 mN is 3.3 um";
}

TEST(Lean, GoesWithEveryOtherEffectInItsCone) {
  // Random motions: slipping elements carry mu(place) f_n g(slip/dt), sticking ones at most mu f_n.
  int slid = 0, stuck = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    RandomStream draw(seed, 0, "lean");
    const PadLayout pad = testing_field::random_pad(draw, 30, seed % 2 == 1);
    const testing_field::RandomMotion motion(draw, Pose{});
    Field field = field_with(pad, {0.5, 0.5},
                             {{"lean", {{"stop_stiffness", 1e5}}},
                              {"viscous_friction", {{"gain", 0.1}, {"speed", 1e-3}}},
                              {"patchy_friction", {}},
                              {"viscoelastic", {}}});
    for (int tick = 0; tick < 300; ++tick) {
      field.step(motion.at(tick * 1e-3), 1e-3);
      for (std::size_t i = 0; i < field.size(); ++i) {
        const double f = field.tangential_force(i).norm(), w = field.slip_step(i).norm() / 1e-3, limit = field.stick_limit(i);
        if (field.state(i) == ElementState::slip) {
          ASSERT_NEAR(f, limit * (1.0 + 0.1 * std::log10(1.0 + w / 1e-3)), 1e-9 * f);
          ASSERT_GE(field.tangential_force(i).dot(field.slip_step(i)), 0.0);
        } else {
          ASSERT_LE(f, limit + 1e-6);
        }
        (field.state(i) == ElementState::slip ? slid : stuck) += 1;
      }
    }
  }
  EXPECT_GT(slid, 1000);
  EXPECT_GT(stuck, 1000);
}

TEST(Lean, RelaxesByItsRheology) {
  // Held upright for 20 relaxation times: e^-20 = 2e-9 is left of the relaxing part, 0.4 k_n d =
  // 0.1 N.
  Field field = field_with(one_unit(k_n, k_t), {0.5, 0.5}, {leaning, {"viscoelastic", {{"relaxation", 0.4}, {"time", 10e-3}}}});
  for (int tick = 0; tick <= 200; ++tick) field.step(at(0.0, 0.0, -shallow), 1e-3);
  EXPECT_NEAR(field.normal_force(0), 0.6 * k_n * shallow, 1e-9);
}

TEST(Lean, RefusesALoadThatItsStopDoesNotHold) {
  // (k_t + k_s) L = 4.38 N.
  Field field = field_with(one_unit(k_n, k_t), {0.5, 0.5}, {leaning});
  field.step(at(0.0, 0.0, -4.37 / k_n), 1e-3);
  EXPECT_THAT(scene_refusal_of([&] { field.step(at(0.0, 0.0, -4.39 / k_n), 1e-3); }),
              refused_at("effects", {"lean", "element 0", "4.39 N", "4.38 N"}));
}

TEST(Lean, RefusesAnEllipticCone) {
  const PadLayout pad = one_unit(k_n, k_t);
  const auto named = [](const char* name) { return Named{name, defaults_of(kind_named(name).about.parameters)}; };
  EXPECT_THAT(refusal_of<SceneValueError>([&] {
                install_effects({named("anisotropic_friction"), named("lean")}, pad, Plane{}, 0, 0);
              }),
              refused_at("effects", {"lean", "anisotropic_friction"}));
}

}  // namespace
}  // namespace slipbench::testing_effects::lean_test
