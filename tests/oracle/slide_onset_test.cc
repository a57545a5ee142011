// Oracle 1: a pad pressed by delta slides at constant v from t = 0. A sticking pillar's shear force
// is k_t v t and its limit is mu k_n delta_p, so it slips at t = mu f_n/(k_t v), f_n = k_n (delta -
// drop_p): lightest-loaded pillars first.
#include <algorithm>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/oracle/pads.h"

namespace slipbench::oracle::slide_onset_test {
namespace {

constexpr double k_n = 7100.0, k_t = 3900.0, compression = 1e-3;

double load(const PadLayout& pad, std::size_t unit) { return k_n * (compression - pad.elements[pad.units[unit].first].tip.z()); }

using Case = std::tuple<double, double, int>;  // speed [m/s], mu, direction in eighths of a turn

struct SlideOnset : testing::TestWithParam<Case> {
  std::vector<double> onsets(const PadLayout& pad, EventKind kind, double dt) const {
    const auto [speed, mu, eighth] = GetParam();
    const double angle = eighth * std::numbers::pi / 4.0;
    Field field(pad, Plane{}, {mu, mu});
    FirstTimes first(9, kind);
    const double longest = 1.6 * mu * k_n * compression / (k_t * speed);
    drive(
        field, dt, std::ceil(1.05 * longest / dt) * dt,
        [&, v = speed](double t) {
          return turned(0.0, {v * t * std::cos(angle), v * t * std::sin(angle), -compression});
        },
        std::ref(first));
    return first.times();
  }
};

TEST_P(SlideOnset, EveryPillarSlipsAtItsClosedFormInTheOrderOfLoads) {
  const auto [speed, mu, eighth] = GetParam();
  const PadLayout pad = nine_pillars();
  const auto times = onsets(pad, EventKind::slip, 1e-3);
  for (std::size_t p = 0; p < 9; ++p) {
    const double exact = mu * load(pad, p) / (k_t * speed);
    EXPECT_NEAR(times[p], exact, 1e-3 * exact) << "pillar " << p;
  }
  // Corners (0, 2, 6, 8) carry least, then edges; the centre carries most.
  const double last_corner = std::max({times[0], times[2], times[6], times[8]});
  const double first_edge = std::min({times[1], times[3], times[5], times[7]});
  const double last_edge = std::max({times[1], times[3], times[5], times[7]});
  EXPECT_LT(last_corner, first_edge);
  EXPECT_LT(last_edge, times[4]);
}

TEST_P(SlideOnset, SixBristlesSlipFromTheLightestToTheHeaviest) {
  // Bristle j carries weight w_j of the mean load at equal stiffness, so it slips at w_j mu
  // f_n/(k_t v): first at 0.4, last at 1.6.
  const auto [speed, mu, eighth] = GetParam();
  const PadLayout pad = nine_pillars(6);
  const auto micro = onsets(pad, EventKind::micro, 1e-3);
  const auto full = onsets(pad, EventKind::slip, 1e-3);
  for (std::size_t p = 0; p < 9; ++p) {
    const double mean = mu * load(nine_pillars(), p) / (k_t * speed);
    EXPECT_NEAR(micro[p], 0.4 * mean, 1e-3 * 0.4 * mean) << "pillar " << p;
    EXPECT_NEAR(full[p], 1.6 * mean, 1e-3 * 1.6 * mean) << "pillar " << p;
  }
}

INSTANTIATE_TEST_SUITE_P(SpeedsFrictionsDirections, SlideOnset,
                         testing::Combine(testing::Values(0.5e-3, 4e-3, 16e-3), testing::Values(0.2, 0.5, 1.0),
                                          testing::Range(0, 8)));

TEST(SlideOnset, ConvergesUnderAnAcceleratingDrive) {
  // s = a t^2/2, so slip begins at t = sqrt(2 mu f_n/(k_t a)). Within a step the field takes the
  // path as linear, a chord of the parabola at most a dt^2/8 above it, so the time is early by at
  // most (a dt^2/8)/(a t) = dt^2/(8 t): quadratic in dt.
  const double mu = 0.5, acceleration = 0.05;
  const PadLayout pad = nine_pillars();
  for (const double dt : {4e-3, 1e-3, 1e-4}) {
    Field field(pad, Plane{}, {mu, mu});
    FirstTimes first(9, EventKind::slip);
    drive(
        field, dt, 0.4,
        [&](double t) {
          return turned(0.0, {0.5 * acceleration * t * t, 0.0, -compression});
        },
        std::ref(first));
    for (std::size_t p = 0; p < 9; ++p) {
      const double exact = std::sqrt(2.0 * mu * load(pad, p) / (k_t * acceleration));
      EXPECT_LE(first.times()[p], exact + 1e-12) << "dt " << dt;
      EXPECT_GE(first.times()[p], exact - dt * dt / (8.0 * (exact - dt)) - 1e-12) << "dt " << dt;
    }
  }
}

TEST(SlideOnset, StaticFrictionAboveKineticLetsTheForceFallOnce) {
  // At onset f_t = mu_s f_n; from then on f_t = mu_k f_n, with no second onset: the latch.
  const double mu_s = 0.6, mu_k = 0.4, speed = 4e-3;
  const PadLayout pad = nine_pillars();
  Field field(pad, Plane{}, {mu_s, mu_k});
  std::vector<int> onsets(9, 0);
  const double last = mu_s * load(pad, 4) / (k_t * speed);
  drive(
      field, 1e-3, 2.0 * last,
      [&](double t) {
        return turned(0.0, {speed * t, 0.0, -compression});
      },
      [&](const ContactFrame& frame) {
        for (const ContactEvent& event : frame.events) {
          if (event.kind != EventKind::slip) continue;
          ++onsets[event.unit];
          const double exact = mu_s * load(pad, event.unit) / (k_t * speed);
          EXPECT_NEAR(event.time, exact, 1e-3 * exact);
        }
        for (Eigen::Index p = 0; p < 9; ++p) {
          const double f_t = std::hypot(frame.force(0, p), frame.force(1, p));
          const double f_n = load(pad, static_cast<std::size_t>(p));
          EXPECT_NEAR(frame.force(2, p), f_n, 1e-12);
          if (frame.unit_state[static_cast<std::size_t>(p)] == UnitState::slip) {
            EXPECT_NEAR(f_t, mu_k * f_n, 1e-12);
          } else {
            EXPECT_LE(f_t, mu_s * f_n * (1.0 + 1e-12));
          }
        }
      });
  EXPECT_EQ(onsets, std::vector<int>(9, 1));
}

TEST(SlideOnset, SlippedDistanceIsTheWayBeyondTheOnset) {
  // Sliding at v with constant stretch: the tip lags the root by mu f_n/k_t, so its path after t is
  // v t - mu f_n/k_t.
  const double mu = 0.5, speed = 4e-3, duration = 1.0;
  const PadLayout pad = nine_pillars();
  Field field(pad, Plane{}, {mu, mu});
  ContactFrame last;
  drive(
      field, 1e-3, duration,
      [&](double t) {
        return turned(0.0, {0.0, -speed * t, -compression});
      },
      [&](const ContactFrame& frame) { last = frame; });
  for (Eigen::Index p = 0; p < 9; ++p) {
    const double stretch = mu * load(pad, static_cast<std::size_t>(p)) / k_t;
    EXPECT_NEAR(last.slip_distance[p], speed * duration - stretch, 1e-12);
    EXPECT_NEAR(last.slip_velocity(0, p), 0.0, 1e-12);
    EXPECT_NEAR(last.slip_velocity(1, p), -speed, 1e-12);
    // The pad moves towards -Y: friction pulls the tips back, towards +Y.
    EXPECT_NEAR(last.displacement(1, p), stretch, 1e-12);
    EXPECT_NEAR(last.force(1, p), k_t * stretch, 1e-9);
  }
  EXPECT_NEAR(last.slip_direction, -std::numbers::pi / 2.0, 1e-9);
  EXPECT_EQ(last.state, PadState::gross);
  EXPECT_EQ(last.stuck_fraction, 0.0);
}

}  // namespace
}  // namespace slipbench::oracle::slide_onset_test
