// Impulses on slipping elements: their number, ringing and strength, and their absence.
#include <cmath>
#include <numbers>

#include "tests/expect.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::asperities_test {
namespace {

constexpr double pi = std::numbers::pi, k_n = 1000.0, k_t = 600.0, depth = 1e-3, load = k_n * depth, mu = 0.5,
                 omega = 2.0 * pi * 180.0, zeta = 0.1;

Field field_of(const std::map<std::string, double>& changes, std::size_t bristles = 1) {
  return field_with(one_unit(k_n, k_t, bristles), {mu, mu},
                    {{"inertia", {{"frequency", 180.0}, {"scatter", 0.0}, {"damping", zeta}}}, {"asperities", changes}});
}

// Returns the force along X minus steady friction mu N, at times dt apart, of a settled slide.
std::vector<double> ringing(Field& field, double speed, double dt, std::size_t samples) {
  // mu N/k_t stretches the spring, and within 0.2 s exp(-zeta omega t) fades below the rounding of
  // the compared values
  const auto settle = static_cast<std::size_t>(std::ceil((mu * load / (k_t * speed) + 0.2) / dt));
  std::vector<double> felt;
  for (std::size_t tick = 0; tick < settle + samples; ++tick) {
    field.step(at(speed * dt * static_cast<double>(tick), 0.0, -depth), dt);
    field.view_from_pad();
    double sum = 0.0;
    for (std::size_t i = 0; i < field.size(); ++i) sum += field.force_on_pad(i).x();
    if (tick >= settle) felt.push_back(-sum - mu * load);
  }
  return felt;
}

// Returns the samples that do not continue the free vibration of the two modes: x[n] is then a
// combination of the four samples before.
std::vector<std::size_t> breaks(const std::vector<double>& x, double dt, double tolerance) {
  const auto mode = [&](double w) {
    return std::pair(-2.0 * std::exp(-zeta * w * dt) * std::cos(w * std::sqrt(1.0 - zeta * zeta) * dt),
                     std::exp(-2.0 * zeta * w * dt));
  };
  const auto [a1, a2] = mode(omega);
  const auto [b1, b2] = mode(2.1 * omega);
  std::vector<std::size_t> found;
  for (std::size_t n = 4; n < x.size(); ++n) {
    const double rest =
        x[n] + (a1 + b1) * x[n - 1] + (a2 + a1 * b1 + b2) * x[n - 2] + (a1 * b2 + a2 * b1) * x[n - 3] + a2 * b2 * x[n - 4];
    if (std::abs(rest) > tolerance) found.push_back(n);
  }
  return found;
}

TEST(Asperities, RingAtTheModesWhateverTheSpeedAndAsOftenAsThePathIsLong) {
  // 40 mm of slip with an asperity every 0.2 mm: 200 of them, within 5 sqrt 200 = 71. Each breaks
  // the recurrence of free vibration in at most 4 consecutive samples; between them the two
  // frequencies and their decay hold at any speed.
  for (const double speed : {3.3e-3, 10e-3, 33e-3}) {
    const double dt = 0.1e-6 / speed;  // 0.1 um per step: hardly ever two within 4 steps
    Field field = field_of({});
    const auto felt = ringing(field, speed, dt, 400000);
    const auto found = breaks(felt, dt, 1e-10);
    ASSERT_FALSE(found.empty());
    std::size_t impulses = 1;
    for (std::size_t k = 1; k < found.size(); ++k) impulses += found[k] > found[k - 1] + 1 ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(impulses), 200.0, 71.0) << "speed " << speed;
    EXPECT_LE(found.size(), 4 * impulses + 8) << "speed " << speed;
  }
}

TEST(Asperities, AUnitMeetsAsManyWhateverItsElements) {
  // Four elements have a quarter of the asperities each.
  const double speed = 10e-3, dt = 1e-5;
  Field field = field_of({}, 4);
  const auto found = breaks(ringing(field, speed, dt, 400000), dt, 1e-10);
  std::size_t impulses = 1;
  for (std::size_t k = 1; k < found.size(); ++k) impulses += found[k] > found[k - 1] + 1 ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(impulses), 200.0, 71.0);
}

TEST(Asperities, SamePathMeetsTheSameWhateverTheStep) {
  const double speed = 10e-3;
  Field fine = field_of({}), coarse = field_of({});
  for (int tick = 0; tick <= 20000; ++tick) {
    const double dt = 1e-4;
    fine.step(at(speed * dt * tick, 0.0, -depth), dt);
    if (tick % 10 != 0) continue;
    coarse.step(at(speed * dt * tick, 0.0, -depth), 10.0 * dt);
    fine.view_from_pad();
    coarse.view_from_pad();
    // The tip's speed over a step is equal once its own swing, started at the onset, has faded.
    if (tick > 5000) {
      ASSERT_NEAR(fine.force_on_pad(0).x(), coarse.force_on_pad(0).x(), 1e-9) << "tick " << tick;
    }
  }
}

TEST(Asperities, StrengthGrowsWithTheRootOfLoadAndSpeed) {
  // Few impulses, without scatter, of the first mode alone: A exp(-zeta w t) sin(w' t), w' = w
  // sqrt(1 - zeta^2), has its maximum A exp(-zeta w t) sqrt(1 - zeta^2) at tan w' t = w'/(zeta w).
  // A = amplitude sqrt(f_n/load) sqrt(v/speed).
  const double turn = std::atan2(std::sqrt(1.0 - zeta * zeta), zeta);
  const double peak = std::exp(-zeta * turn / std::sqrt(1.0 - zeta * zeta)) * std::sqrt(1.0 - zeta * zeta);
  for (const double speed : {5e-3, 20e-3}) {
    for (const double reference : {0.5, 2.0}) {
      Field field = field_of({{"distance", 20e-3}, {"scatter", 0.0}, {"second", 0.0}, {"load", reference}, {"amplitude", 3e-3}});
      double largest = 0.0;
      for (const double force : ringing(field, speed, 1e-5, static_cast<std::size_t>(0.1 / speed / 1e-5))) {
        largest = std::max(largest, std::abs(force));
      }
      const double expected = 3e-3 * std::sqrt(load / reference) * std::sqrt(speed / 10e-3) * peak;
      EXPECT_NEAR(largest, expected, 0.02 * expected) << speed << " m/s, " << reference << " N";
    }
  }
}

TEST(Asperities, StuckElementsAreSilent) {
  const std::vector<Wanted> mass{{"inertia", {}}};
  Field with = field_of({{"distance", 1e-6}}),
        without =
            field_with(one_unit(k_n, k_t), {mu, mu}, {{"inertia", {{"frequency", 180.0}, {"scatter", 0.0}, {"damping", zeta}}}});
  for (int tick = 0; tick < 1000; ++tick) {
    for (Field* field : {&with, &without}) {
      field->step(at(1e-7 * tick, 0.0, -depth), 1e-4);
      field->view_from_pad();
    }
    ASSERT_EQ(with.state(0), ElementState::stick);
    ASSERT_EQ(with.force_on_pad(0), without.force_on_pad(0));
  }
}

TEST(Asperities, NeedsAnInertiaThatRings) {
  const auto refusal = [](const std::vector<Wanted>& wanted) -> std::string {
    return refusal_of<SceneValueError>([&] { installed(one_unit(k_n, k_t), wanted); });
  };
  EXPECT_THAT(refusal({{"asperities", {}}}), refused_at("effects", {"asperities", "inertia"}));
  EXPECT_THAT(refusal({{"inertia", {{"damping", 1.0}}}, {"asperities", {}}}),
              refused_at("effects", {"asperities", "damping", "1"}));
}

}  // namespace
}  // namespace slipbench::testing_effects::asperities_test
