// The motors' vibration: its lines, its strength and its silence.
#include "sim/motion/motor_vibration.h"
#include "sim/api/motion.h"
#include "sim/core/random.h"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench::motor_vibration_test {
namespace {

constexpr double pi = std::numbers::pi, dt = 1e-4;

MotorVibration motors(const MotorSettings& settings = {.sd = 0.0}, std::uint64_t trial = 0) {
  return {settings, RandomStream(1, trial, "motors")};
}

BodyState stage(double x, double v) {
  BodyState state;
  state.pose.position = {x, 0.0, 0.0};
  state.velocity = {v, 0.0, 0.0};
  return state;
}

// Transfer of the frame's modes for a force of frequency f: sum -f^2/(f_r^2 - f^2 + 2 i zeta_r f_r
// f). Each of the five passes the force minus the share of its spring and dashpot. The modes take
// the force as linear between samples, which weakens it by (sin x/x)^2, x = pi f dt.
std::complex<double> passed(double f) {
  const double x = pi * f * dt;
  std::complex<double> sum = 0.0;
  for (std::size_t r = 0; r < 5; ++r) {
    const double f_r = MotorVibration::mode_frequencies[r], zeta = MotorVibration::mode_damping[r];
    const std::complex<double> held = 1.0 + f * f / std::complex<double>(f_r * f_r - f * f, 2.0 * zeta * f_r * f);
    sum += 1.0 - std::pow(std::sin(x) / x, 2) * held;
  }
  return sum;
}

TEST(MotorVibration, HasItsLinesAtTheOrdersOfTheSpindle) {
  // At v = 10 mm/s and a lead of 8 mm the spindle turns at 1.25 Hz. A line of the excitation has
  // the amplitude 1.6 mN/sqrt(7), at 40 mm/s twice that. In addition there is noise of one pole f_c
  // = 200 v/lead: one-sided density S = A^2/(pi f_c)/(1 + (f/f_c)^2) before the modes, A^2 = 2.56
  // mN^2 v/(10 mm/s). Under a Hann taper over T it adds an error of variance 3/2 S/T to each
  // component of an amplitude; five standard errors are allowed.
  constexpr int count = 400000;
  // An idle axis sounds like one that carries the pad.
  for (const auto& [v, idle] : {std::pair{10e-3, false}, std::pair{40e-3, false}, std::pair{40e-3, true}}) {
    MotorVibration shaking = motors({.sd = 0.0, .idle_speed = idle ? v : 0.0});
    std::vector<double> force;
    for (int k = 0; k < count; ++k) {
      const BodyState now = idle ? stage(0.0, 0.0) : stage(v * dt * k, v);
      force.push_back(shaking.force(now, false, dt) * (1.0 - std::cos(2.0 * pi * k / count)));
    }
    const double f_c = 200.0 * v / 8e-3, time = count * dt, power = v / MotorVibration::reference_speed;
    for (const int order : MotorVibration::orders) {
      const double f = order * v / 8e-3;
      std::complex<double> sum = 0.0;
      for (int k = 0; k < count; ++k) {
        sum += force[static_cast<std::size_t>(k)] * std::polar(1.0, -2.0 * pi * std::fmod(f * dt * k, 1.0));
      }
      const double gain = std::abs(passed(f)), expected = 1.6e-3 * std::sqrt(power / 7.0) * gain;
      const double density = 1.6e-3 * 1.6e-3 * power / (pi * f_c) / (1.0 + std::pow(f / f_c, 2));
      EXPECT_NEAR(2.0 / count * std::abs(sum), expected, 5.0 * gain * std::sqrt(3.0 * density / time)) << order << " at " << v;
    }
  }
}

TEST(MotorVibration, HearsAnIdleAxisFromItsStartOnAndDrawsNothingForNone) {
  constexpr double start = 0.5;
  MotorVibration idle = motors({.sd = 0.0, .idle_speed = 10e-3, .idle_start = start});
  MotorVibration none = motors({.sd = 0.0, .idle_start = start});
  double heard = 0.0;
  for (int k = 0; k < 10000; ++k) {
    const double force = idle.force(stage(0.0, 0.0), false, dt);
    if (k < start / dt - 0.5) {
      ASSERT_EQ(force, 0.0) << k;
    }
    heard += force * force;
    ASSERT_EQ(none.force(stage(0.0, 0.0), false, dt), 0.0);
  }
  EXPECT_GT(heard, 0.0);
}

TEST(MotorVibration, HumsAtRestAsNoiseOfAnAxisAtRestSpeed) {
  // Motors that hold give noise alone: mean square A^2/2, A = 1.6 mN sqrt(2 mm/s/10 mm/s), of one
  // pole f_c = 200 v/lead = 50 Hz, so the one-sided density is A^2/(pi f_c)/(1 + (f/f_c)^2).
  // Sampled at the steps, the density at f is that of e^(-|k| b), b = 2 pi f_c dt,
  //   A^2 dt (1 - E^2)/(1 - 2 E cos(2 pi f dt) + E^2),  E = e^-b,
  // and the modes pass |passed(f)|^2 of it. A periodogram of n = 400 segments has a standard error
  // of 1/sqrt(n) = 5 % (Hann, no overlap). A mode of half width zeta f_r = 2.25 Hz is narrower than
  // a bin of 10 Hz; the bins at 400 and 800 Hz are away from all modes.
  constexpr int segment = 1000, segments = 400;
  MotorVibration shaking = motors({.sd = 0.0, .rest_speed = 2e-3});
  for (int k = 0; k < 5000; ++k) shaking.force(stage(0.0, 0.0), false, dt);  // the modes settle
  double power_400 = 0.0, power_800 = 0.0;
  for (int s = 0; s < segments; ++s) {
    std::complex<double> at_400 = 0.0, at_800 = 0.0;
    for (int k = 0; k < segment; ++k) {
      const double tapered = shaking.force(stage(0.0, 0.0), false, dt) * (1.0 - std::cos(2.0 * pi * k / segment));
      at_400 += tapered * std::polar(1.0, -2.0 * pi * 400.0 * dt * k);
      at_800 += tapered * std::polar(1.0, -2.0 * pi * 800.0 * dt * k);
    }
    // One-sided: 2 dt |sum|^2 over the taper's sum of squares, 3/2 of the segment.
    power_400 += 2.0 * dt * std::norm(at_400) / (1.5 * segment) / segments;
    power_800 += 2.0 * dt * std::norm(at_800) / (1.5 * segment) / segments;
  }
  const double square = 1.6e-3 * 1.6e-3 * 0.2, keeps = std::exp(-2.0 * pi * 50.0 * dt);
  const auto expected = [&](double f) {
    return square * dt * (1.0 - keeps * keeps) / (1.0 - 2.0 * keeps * std::cos(2.0 * pi * f * dt) + keeps * keeps) *
           std::norm(passed(f));
  };
  EXPECT_NEAR(power_400 / expected(400.0), 1.0, 5.0 / std::sqrt(segments));
  EXPECT_NEAR(power_800 / expected(800.0), 1.0, 5.0 / std::sqrt(segments));
}

TEST(MotorVibration, GrowsInProportionToItsLevel) {
  MotorVibration once = motors({.level = 1.0}), twice = motors({.level = 2.0}),
                 touching = motors({.level = 1.0, .in_contact = 4.0});
  for (int k = 0; k < 3000; ++k) {
    const BodyState now = stage(1e-6 * k, 10e-3);
    const double force = once.force(now, false, dt);
    ASSERT_EQ(twice.force(now, false, dt), 2.0 * force) << "powers of two are exact";
    ASSERT_EQ(touching.force(now, true, dt), 4.0 * force);
  }
}

TEST(MotorVibration, DiffersFromRecordingToRecording) {
  MotorVibration one = motors({}, 1), same = motors({}, 1), other = motors({}, 2);
  double differ = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double force = one.force(stage(1e-6 * k, 10e-3), false, dt);
    ASSERT_EQ(same.force(stage(1e-6 * k, 10e-3), false, dt), force);
    differ += std::abs(other.force(stage(1e-6 * k, 10e-3), false, dt) - force);
  }
  EXPECT_GT(differ, 0.0);
}

TEST(MotorVibration, IsSilentWhileNothingHasMovedAndRingsOutWhenItStops) {
  MotorVibration shaking = motors();
  for (int k = 0; k < 10; ++k) ASSERT_EQ(shaking.force(stage(0.0, 0.0), true, dt), 0.0);
  double loudest = 0.0;
  for (int k = 0; k < 5000; ++k) loudest = std::max(loudest, std::abs(shaking.force(stage(1e-6 * k, 10e-3), true, dt)));
  EXPECT_GT(loudest, 1e-3);
  // The slowest mode decays by at least zeta w = 0.03 2 pi 75 Hz = 14.1/s: to 1e-12 within 2 s,
  // after which it is set to 0.
  for (int k = 0; k < 25000; ++k) shaking.force(stage(5e-3, 0.0), true, dt);
  EXPECT_EQ(shaking.force(stage(5e-3, 0.0), true, dt), 0.0);
}

TEST(MotorVibration, FollowsTheSpindleThroughAChangeOfSpeed) {
  // While the speed changes from 5 to 20 mm/s in 0.1 s no step of the force exceeds five times the
  // rms of the steps at 20 mm/s.
  MotorVibration steady = motors(), changing = motors();
  double square = 0.0, last = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double force = steady.force(stage(2e-6 * k, 20e-3), false, dt);
    if (k > 5000) square += (force - last) * (force - last) / 15000.0;
    last = force;
  }
  double x = 0.0, largest = 0.0;
  for (int k = 0; k < 20000; ++k) {
    const double v = std::clamp(5e-3 + 150e-3 * (k - 10000) * dt, 5e-3, 20e-3);
    x += v * dt;
    const double force = changing.force(stage(x, v), false, dt);
    if (k > 0) largest = std::max(largest, std::abs(force - last));
    last = force;
  }
  EXPECT_LT(largest, 5.0 * std::sqrt(square));
}

}  // namespace
}  // namespace slipbench::motor_vibration_test
