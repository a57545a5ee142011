// The noise against its law: autocorrelation rho(tau) = exp(-w tau)(1 + w tau), variance sd^2.
//
// Statistics are taken over `many` independent sources. For standard normal x, y of correlation
// rho, the mean of x*y has the standard error sqrt((1 + rho^2)/many); the mean of x^2 (or of any
// normal variable squared, relative to its variance) has sqrt(2/many) = 1 %. Five standard errors
// are allowed.

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "tests/sensors/electronics/model.h"

namespace slipbench {
namespace {

constexpr double corner = 16.0;  // Hz, the default

double correlation_of_law(double tau) {
  const double phase = 2.0 * std::numbers::pi * corner * tau;
  return std::exp(-phase) * (1.0 + phase);
}

double mean_product(const std::vector<float>& a, const std::vector<float>& b, std::size_t count) {
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return sum / static_cast<double>(count);
}

std::vector<double> times_at(double rate, std::size_t count) {
  std::vector<double> times;
  for (std::size_t k = 0; k < count; ++k) times.push_back(static_cast<double>(k) / rate);
  return times;
}

class NoiseAtRate : public testing::TestWithParam<double> {};

TEST_P(NoiseAtRate, HasTheAutocorrelationOfTwoEqualPoles) {
  const double rate = GetParam();
  // 40 ms is w*tau = 4, where the correlation has fallen to 9 %.
  const auto samples = static_cast<std::size_t>(std::lround(0.04 * rate)) + 1;
  const auto x = outputs({part("noise")}, two_values_a_source(many, rate), 0.0F, times_at(rate, samples));
  for (std::size_t k = 0; k < samples; ++k) {
    const double rho = correlation_of_law(static_cast<double>(k) / rate);
    const double standard_error = std::sqrt((1.0 + rho * rho) / static_cast<double>(many));
    EXPECT_NEAR(mean_product(x[0], x[k], many), rho, 5.0 * standard_error) << "lag " << k;
  }
}

TEST_P(NoiseAtRate, IsAsSmoothAsTheLawSays) {
  // The increment over one sample has the variance 2(1 - rho). It distinguishes a slope of -4 in
  // the power spectrum (finite x') from one of -2: for a single pole at 1 kHz it would be 20 times
  // as large.
  const double rate = GetParam();
  const auto x = outputs({part("noise")}, two_values_a_source(many, rate), 0.0F, times_at(rate, 2));
  double sum = 0.0;
  for (std::size_t i = 0; i < many; ++i) {
    const double increment = static_cast<double>(x[1][i]) - static_cast<double>(x[0][i]);
    sum += increment * increment;
  }
  const double expected = 2.0 * (1.0 - correlation_of_law(1.0 / rate));
  EXPECT_NEAR(sum / static_cast<double>(many) / expected, 1.0, 5.0 * std::sqrt(2.0 / static_cast<double>(many)));
}

TEST_P(NoiseAtRate, IsStationaryFromTheFirstSample) {
  const double rate = GetParam();
  const auto x = outputs({part("noise")}, two_values_a_source(many, rate), 0.0F, times_at(rate, 31));
  const double rho = correlation_of_law(5.0 / rate);
  for (const std::size_t start : {0U, 1U, 5U, 25U}) {
    EXPECT_NEAR(mean_product(x[start], x[start], many), 1.0, 5.0 * std::sqrt(2.0 / static_cast<double>(many))) << start;
    EXPECT_NEAR(mean_product(x[start], x[start + 5], many), rho, 5.0 * std::sqrt((1.0 + rho * rho) / static_cast<double>(many)))
        << start;
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, NoiseAtRate, testing::Values(100.0, 250.0, 500.0, 1000.0));

TEST(Noise, FollowsItsCorner) {
  // With the corner at 32 Hz the correlation at 10 ms equals that of 16 Hz at 20 ms.
  Named fast = part("noise");
  fast.parameters.set("corner", 2.0 * corner);
  const auto x = outputs({fast}, two_values_a_source(many, 100.0), 0.0F, times_at(100.0, 2));
  const double rho = correlation_of_law(0.02);
  EXPECT_NEAR(mean_product(x[0], x[1], many), rho, 5.0 * std::sqrt((1.0 + rho * rho) / static_cast<double>(many)));
}

TEST(Noise, HasTheSpectrumOfTwoEqualPoles) {
  // The power at one frequency is chi-squared with two degrees of freedom: its mean over the
  // sources has a relative standard error of 1/sqrt(5000) = 1.4 %. The window (Hann, 0.5 s) blurs
  // the spectrum by some Hz and sampling folds its tail back; the law's autocorrelation goes
  // through the same transform, so neither counts as an error. Leakage does not reach the highest
  // frequency, where the law is 2^-12 of its value at 0: the window's side lobes fall with the
  // sixth power of frequency.
  constexpr std::size_t samples = 500;
  constexpr std::size_t sources = 5000;
  const auto x = outputs({part("noise")}, two_values_a_source(sources), 0.0F, times_at(1000.0, samples));
  const auto window = [](std::size_t k) {
    return 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / samples);
  };
  const auto measured_power = [&](double f) {
    double power = 0.0;
    for (std::size_t s = 0; s < sources; ++s) {
      double re = 0.0;
      double im = 0.0;
      for (std::size_t k = 0; k < samples; ++k) {
        const double phase = 2.0 * std::numbers::pi * f * static_cast<double>(k) / 1000.0;
        re += window(k) * static_cast<double>(x[k][s]) * std::cos(phase);
        im += window(k) * static_cast<double>(x[k][s]) * std::sin(phase);
      }
      power += re * re + im * im;
    }
    return power / static_cast<double>(sources);
  };
  const auto power_of_law = [&](double f) {
    double power = 0.0;
    for (std::size_t i = 0; i < samples; ++i) {
      for (std::size_t k = 0; k < samples; ++k) {
        const double tau = (static_cast<double>(i) - static_cast<double>(k)) / 1000.0;
        power += window(i) * window(k) * correlation_of_law(std::abs(tau)) * std::cos(2.0 * std::numbers::pi * f * tau);
      }
    }
    return power;
  };
  for (const double f : {8.0, 32.0, 128.0}) {
    EXPECT_NEAR(measured_power(f) / power_of_law(f), 1.0, 5.0 / std::sqrt(static_cast<double>(sources))) << f << " Hz";
  }
}

TEST(Noise, ValuesOfOneSourceCarryTheSameProcess) {
  const std::size_t sources = 100;
  const auto x = outputs({part("noise")}, two_values_a_source(sources), 0.0F, times_at(1000.0, 20));
  for (const auto& sample : x) {
    for (std::size_t s = 0; s < sources; ++s) EXPECT_FLOAT_EQ(sample[sources + s], 3.0F * sample[s]);
  }
}

TEST(Noise, SourcesAreIndependent) {
  const auto x = outputs({part("noise")}, two_values_a_source(many), 0.0F, {0.0});
  std::vector<float> shifted(x[0].begin() + 1, x[0].begin() + many);
  // The mean of a product of independent standard normals has the standard error 1/sqrt(n).
  EXPECT_NEAR(mean_product(x[0], shifted, many - 1), 0.0, 5.0 / std::sqrt(static_cast<double>(many)));
}

}  // namespace
}  // namespace slipbench
