// A rough surface: its height, its spectrum and its isotropy.
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/expect.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::roughness_test {
namespace {

constexpr double pi = std::numbers::pi, height = 5e-6;

// The heights of the surface at n points a step (dx, dy) apart.
std::vector<double> heights(const std::map<std::string, double>& changes, const std::map<std::string, int>& numbers,
                            std::size_t n, double dx, double dy) {
  const EffectKind& kind = kind_named("roughness");
  Parameters parameters = defaults_of(kind.about.parameters);
  for (const auto& [key, value] : changes) parameters.set(key, value);
  for (const auto& [key, value] : numbers) parameters.set(key, std::int64_t{value});
  FieldEffects effects;
  kind.install(parameters, context_for(one_unit(1000.0, 600.0), true, 7, 0), effects);
  std::vector<double> x(n), y(n), gap(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    x[k] = dx * (static_cast<double>(k) - 0.3 * static_cast<double>(n));  // also where coordinates are negative
    y[k] = dy * (static_cast<double>(k) - 0.3 * static_cast<double>(n));
  }
  effects.surface.front()->displace(n, x.data(), y.data(), std::vector<double>(n, 1.0).data(), gap.data());
  for (double& g : gap) g = -g;
  return gap;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return sum / static_cast<double>(values.size());
}

double amplitude(const std::vector<double>& values, std::size_t waves) {
  std::complex<double> sum = 0.0;
  const double n = static_cast<double>(values.size());
  for (std::size_t k = 0; k < values.size(); ++k) {
    sum += values[k] * std::polar(1.0, -2.0 * pi * static_cast<double>(waves * k % values.size()) / n);
  }
  return 2.0 / n * std::abs(sum);
}

TEST(Roughness, OneWaveIsHeardAtSpeedOverWavelength) {
  // 1 s at 33 mm/s over waves of 0.3 mm: 110 periods. f_n = k_n (d - h): amplitude k_n height sqrt
  // 2 in bin 110, to 0.3 % (the table's error), and 0 elsewhere.
  const double k_n = 1000.0, v = 33e-3, wavelength = 0.3e-3;
  const int samples = 8192;
  EffectKind kind = kind_named("roughness");
  Parameters parameters = defaults_of(kind.about.parameters);
  parameters.set("shortest", wavelength);
  parameters.set("longest", wavelength);
  parameters.set("directions", std::int64_t{1});
  FieldEffects effects;
  const PadLayout pad = one_unit(k_n, 600.0);
  kind.install(parameters, context_for(pad, true, 7, 0), effects);
  Field field(pad, Plane{}, {0.0, 0.0}, std::move(effects));
  std::vector<double> force;
  for (int k = 0; k < samples; ++k) {
    field.step(at(v * k / samples, 0.0, -1e-3), 1.0 / samples);
    force.push_back(field.normal_force(0));
  }
  const double expected = k_n * height * std::numbers::sqrt2;
  for (std::size_t bin = 1; bin < 400; ++bin) {
    EXPECT_NEAR(amplitude(force, bin), bin == 110 ? expected : 0.0, 4e-3 * expected) << "bin " << bin;
  }
}

TEST(Roughness, HeightIsAsAskedAndSpectrumFallsAsAsked) {
  // One direction repeats after 8 longest waves: 24 mm hold the waves 8 to 400. Their amplitudes
  // are a n^-p, with rms^2 = sum a^2 n^-2p/2.
  for (const double exponent : {1.3, 2.0}) {
    const std::size_t n = 16384;
    const auto h =
        heights({{"exponent", exponent}, {"height", height}}, {{"directions", 1}}, n, 24e-3 / static_cast<double>(n), 0.0);
    EXPECT_NEAR(std::sqrt(mean_square(h)), height, 1e-3 * height);
    double power = 0.0;
    for (int wave = 8; wave <= 400; ++wave) power += 0.5 * std::pow(wave, -2.0 * exponent);
    const double a = height / std::sqrt(power);
    for (const std::size_t wave : {8U, 20U, 100U, 400U}) {
      const double expected = a * std::pow(static_cast<double>(wave), -exponent);
      EXPECT_NEAR(amplitude(h, wave), expected, 4e-3 * expected) << "wave " << wave;
    }
    for (const std::size_t wave : {1U, 7U, 401U, 600U}) EXPECT_LT(amplitude(h, wave), 1e-6 * height) << "wave " << wave;
  }
}

TEST(Roughness, AllWaysAreAlike) {
  // Three profiles of one wave each, amplitude A = height sqrt(2/3), at 60 degrees. Along a path at
  // the angle t the mean square of the slope is sum_j (A k cos(t - a_j))^2/2 = (A k)^2/2 * 3/2 =
  // (height k)^2/2 for any t; that of the height is height^2, unless the path follows a ridge; that
  // of the curvature is height^2 k^4 (sum cos^4)/3 = height^2 k^4 3/8.
  const double wavelength = 1e-3, k = 2.0 * pi / wavelength, step = wavelength / 128.0;
  for (const double angle : {0.1, 0.9, 2.0}) {
    const auto h = heights({{"shortest", wavelength}, {"longest", wavelength}, {"height", height}}, {{"directions", 3}}, 200000,
                           step * std::cos(angle), step * std::sin(angle));
    EXPECT_NEAR(mean_square(h), height * height, 0.02 * height * height) << angle;
    // Differences over 32 points of the path: sin(k cos(t - a_j) s/2)^2 in place of (k cos s/2)^2,
    // s = wavelength/32: within 1 %.
    std::vector<double> slope, curvature;
    for (std::size_t i = 4; i + 4 < h.size(); ++i) {
      slope.push_back((h[i + 2] - h[i - 2]) / (4.0 * step));
      curvature.push_back((h[i + 4] - 2.0 * h[i] + h[i - 4]) / (16.0 * step * step));
    }
    EXPECT_NEAR(mean_square(slope), 0.5 * std::pow(height * k, 2), 0.03 * 0.5 * std::pow(height * k, 2)) << angle;
    EXPECT_NEAR(mean_square(curvature), 0.375 * std::pow(height * k * k, 2), 0.03 * 0.375 * std::pow(height * k * k, 2)) << angle;
  }
}

TEST(Roughness, LongestStepSeesTheShortestWaveSixteenTimes) {
  const FieldEffects effects = installed(one_unit(1000.0, 600.0), {{"roughness", {{"shortest", 12e-6}}}});
  EXPECT_DOUBLE_EQ(effects.surface[0]->longest_step(33e-3), 12e-6 / (16.0 * 33e-3));
  // The default is the wavelength that 10 kHz resolves at the fastest published slide.
  const FieldEffects usual = installed(one_unit(1000.0, 600.0), {{"roughness", {}}});
  EXPECT_GE(usual.surface[0]->longest_step(33e-3), 1e-4);
}

std::string refusal(const std::vector<Wanted>& wanted, bool flat) {
  return refusal_of<SceneValueError>([&] { installed(one_unit(1000.0, 600.0), wanted, flat); });
}

TEST(Roughness, RefusesWhatItCannotTabulate) {
  EXPECT_THAT(refusal({{"roughness", {}}}, false), refused_at("effects", {"roughness", "plane", "box"}));
  EXPECT_THAT(refusal({{"roughness", {{"shortest", 4e-3}}}}, true), refused_at("effects", {"roughness", "3 mm", "4 mm", "1000"}));
  EXPECT_THAT(refusal({{"roughness", {{"shortest", 1e-6}}}}, true), refused_at("effects", {"roughness", "3 mm", "1 um", "1000"}));
}

}  // namespace
}  // namespace slipbench::testing_effects::roughness_test
