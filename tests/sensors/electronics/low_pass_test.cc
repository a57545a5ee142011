// The analogue low-pass against its closed forms.
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "sensors/electronics/electronics.h"
#include "tests/expect.h"
#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

// Two equal poles, together -3 dB at 235 Hz: each is 1.5 dB down there, so w = 2 pi
// 235/sqrt(sqrt(2) - 1) = 2294.2 rad/s, a corner of 365.1 Hz.
const double w = 2.0 * std::numbers::pi * 235.0 / std::sqrt(std::numbers::sqrt2 - 1.0);
constexpr double single = 2e-7;  // rounding of a float near 1

// The filter's output for `input(t)` at every `step` [s], up to but not including `end` [s].
template <class Input>
std::vector<double> filtered(Input input, double step, double end, double corner = 235.0) {
  Named low_pass = part("low_pass");
  low_pass.parameters.set("corner", corner);
  Electronics electronics({low_pass}, two_values_a_source(1), default_key);
  std::vector<double> result;
  for (int k = 0; k * step < end - 1e-9; ++k) {
    std::vector<float> values(2, static_cast<float>(input(k * step)));
    electronics.feel(values, k * step);
    result.push_back(static_cast<double>(values[0]));
  }
  return result;
}

// The response to a ramp x = t/h is R(t)/h, R = t - 2/w + (t + 2/w) exp(-w t); a step that takes
// one tick h is two ramps, h apart.
double ramp(double t) { return t <= 0.0 ? 0.0 : t - 2.0 / w + (t + 2.0 / w) * std::exp(-w * t); }

TEST(LowPass, AStepFollowsItsClosedForm) {
  for (const double h : {1e-3, 1e-4}) {
    const auto y = filtered([&](double t) { return t > 0.5 * h ? 1.0 : 0.0; }, h, 10e-3);
    for (std::size_t k = 0; k < y.size(); ++k) {
      const double t = static_cast<double>(k) * h;
      EXPECT_NEAR(y[k], (ramp(t) - ramp(t - h)) / h, single) << "h = " << h << ", tick " << k;
    }
  }
}

// (1 + u) exp(-u) = 1/2 at u = 1.678: 0.7316 ms after the step, whose middle is at 0.05 ms because
// it takes from 0 to 0.1 ms.
TEST(LowPass, AStepIsAtHalfWhenItsPolesSay) {
  const double h = 1e-4;
  const auto y = filtered([&](double t) { return t > 0.5 * h ? 1.0 : 0.0; }, h, 10e-3);
  std::size_t k = 0;
  while (y[k] < 0.5) ++k;
  const double half = h * (static_cast<double>(k) - (y[k] - 0.5) / (y[k] - y[k - 1]));
  EXPECT_NEAR((half - 0.5 * h) / (1.6783 / w), 1.0, 0.03);
}

// z/x| = 1/(1 + (2 pi f/w)^2). A signal that is linear between ticks contains the sine with the
// factor sinc(f h)^2: 0.995 at 400 Hz and 0.1 ms.
TEST(LowPass, AVibrationHasTheAmplitudeOfTwoEqualPoles) {
  const double h = 1e-4;
  for (const double f : {50.0, 235.0, 400.0}) {
    const auto y = filtered([&](double t) { return std::sin(2.0 * std::numbers::pi * f * t); }, h, 0.22);
    std::complex<double> sum;  // over 0.2 s, whole periods of all three, after the transient
    for (std::size_t k = 200; k < 2200; ++k) {
      const double phase = 2.0 * std::numbers::pi * f * h * static_cast<double>(k);
      sum += y[k] * std::polar(1.0, -phase);
    }
    const double amplitude = 2.0 * std::abs(sum) / 2000.0, ratio = 2.0 * std::numbers::pi * f / w;
    const double sinc = std::sin(std::numbers::pi * f * h) / (std::numbers::pi * f * h);
    EXPECT_NEAR(amplitude, sinc * sinc / (1.0 + ratio * ratio), 1e-6) << f;
    EXPECT_NEAR(amplitude * (1.0 + ratio * ratio), 1.0, 0.03) << f;
    if (f == 235.0) {
      EXPECT_NEAR(1.0 / (1.0 + ratio * ratio), std::numbers::sqrt2 / 2.0, 1e-12) << "-3 dB";
    }
  }
}

// The signal is linear between the ticks at 1 ms, so ticks between them change nothing.
TEST(LowPass, IsTheSameAtEveryTick) {
  const auto straight = [](double t) {
    const double from = std::floor(1e3 * t + 1e-6), share = 1e3 * t - from;
    return std::sin(from) + share * (std::sin(from + 1.0) - std::sin(from));
  };
  const auto coarse = filtered(straight, 1e-3, 20e-3), fine = filtered(straight, 1.25e-4, 20e-3);
  for (std::size_t k = 0; k < coarse.size(); ++k) EXPECT_NEAR(coarse[k], fine[8 * k], 3.0 * single) << k;
}

TEST(LowPass, BeginsSettledAndWithoutACornerChangesNothing) {
  for (const double y : filtered([](double) { return 0.7; }, 1e-3, 10e-3)) EXPECT_NEAR(y, 0.7, single);
  const auto wave = [](double t) { return std::sin(1e3 * t); };
  const auto y = filtered(wave, 1e-3, 10e-3, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < y.size(); ++k)
    EXPECT_EQ(y[k], static_cast<double>(static_cast<float>(wave(1e-3 * static_cast<double>(k)))));
}

TEST(LowPass, TwoCallsAtOneTimeHaveOneAnswer) {
  Electronics electronics({part("low_pass")}, two_values_a_source(1), default_key);
  std::vector<float> values;
  const auto at = [&](double time, float input) {
    values.assign(2, input);
    electronics.feel(values, time);
    return values[0];
  };
  EXPECT_EQ(at(0.0, 0.0F), 0.0F);
  const float once = at(1e-3, 1.0F);
  EXPECT_GT(once, 0.0F);
  EXPECT_EQ(at(1e-3, 5.0F), once);
}

// No other part works between samples, so none may come before this one.
TEST(LowPass, ComesFirst) {
  EXPECT_THAT(
      scene_refusal_of([] {
        Electronics({part("gain"), part("low_pass")}, two_values_a_source(1), default_key);
      }),
      AllOf(StartsWith("sensors.pad.electronics | "), HasSubstr("'low_pass' comes after 'gain'"), HasSubstr("must come first")));
  EXPECT_TRUE(Electronics({part("low_pass"), part("gain")}, two_values_a_source(1), default_key).feels_every_tick());
  EXPECT_FALSE(Electronics({part("gain")}, two_values_a_source(1), default_key).feels_every_tick());
  EXPECT_FALSE(Electronics({}, two_values_a_source(1), default_key).feels_every_tick());
}

}  // namespace
}  // namespace slipbench
