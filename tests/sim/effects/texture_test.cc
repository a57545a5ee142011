// Ridges: the normal force of a slide over them.
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "tests/expect.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::texture_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0, depth = 1e-3, height = 30e-6, wavelength = 4e-3, pi = std::numbers::pi;

TEST(Texture, NormalForceFollowsTheRidgesPointByPoint) {
  // f_z = k_n (d + h sin(2 pi s/wavelength)) with s the path of the tip across the ridges: without
  // friction that of its root.
  for (const double angle : {0.0, 0.6, pi / 2.0}) {
    Field field = field_with(one_unit(k_n, k_t), {0.0, 0.0},
                             {{"texture", {{"height", height}, {"wavelength", wavelength}, {"angle", angle}}}});
    for (int k = 0; k < 300; ++k) {
      const double x = 37e-6 * k, y = -11e-6 * k;
      field.step(at(x, y, -depth), 1e-3);
      if (k == 1) continue;  // stuck in its first step, so its onset is where the tip was
      const double across = x * std::cos(angle) + y * std::sin(angle);
      EXPECT_NEAR(field.normal_force(0), k_n * (depth + height * std::sin(2.0 * pi * across / wavelength)), 1e-12);
    }
  }
}

// Normal force of a slide at 40 mm/s over 10 ridges, 1 s long, after 10 other ridges.
std::vector<double> force_of_slide(double mu, int samples) {
  Field field = field_with(one_unit(k_n, k_t), {mu, mu}, {{"texture", {{"height", height}, {"wavelength", wavelength}}}});
  std::vector<double> force;
  for (int k = 0; k < 2 * samples; ++k) {
    field.step(at(40e-3 * k / samples, 0.0, -depth), 1.0 / samples);
    if (k >= samples) force.push_back(field.normal_force(0));
  }
  return force;
}

double amplitude(const std::vector<double>& force, int bin) {
  std::complex<double> sum = 0.0;
  const double turn = -2.0 * pi * bin / static_cast<double>(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) sum += force[k] * std::polar(1.0, turn * static_cast<double>(k));
  return 2.0 / static_cast<double>(force.size()) * std::abs(sum);
}

TEST(Texture, SlideVibratesAtSpeedOverWavelength) {
  // Without friction the tip moves with its root: 10 periods, bin 10 of the spectrum, amplitude k_n
  // h = 30 mN; 0 elsewhere.
  const std::vector<double> force = force_of_slide(0.0, 1000);
  for (int bin = 1; bin < 50; ++bin) EXPECT_NEAR(amplitude(force, bin), bin == 10 ? k_n * height : 0.0, 1e-12) << "bin " << bin;
}

TEST(Texture, SlidingTipTrailsByTheStretchThatTheRidgesThemselvesChange) {
  // The tip is at x, with phase E = 2 pi x/wavelength: x = v t - mu k_n (d + h sin E)/k_t, so that
  // M = E + e sin E grows with v, where e = (2 pi/wavelength) mu k_n h/k_t = 0.024. As in Kepler's
  // equation (with -e), sin E = (2/e) sum over n of (-1)^(n+1) J_n(n e)/n sin(n M): period
  // wavelength/v, amplitudes 2 k_n h J_n(n e)/(n e). The field's stretch is one step old, an error
  // of first order: at most k_n h e (2 pi/wavelength) v dt in the force.
  const double mu = 0.3, e = 2.0 * pi / wavelength * mu * k_n * height / k_t;
  for (const int samples : {1000, 4000}) {
    const std::vector<double> force = force_of_slide(mu, samples);
    const double step_old = k_n * height * e * 2.0 * pi / wavelength * 40e-3 / samples;
    for (int n = 1; n <= 3; ++n) {
      const double exact = 2.0 * k_n * height * std::cyl_bessel_j(n, n * e) / (n * e);
      EXPECT_NEAR(amplitude(force, 10 * n), exact, step_old) << samples << ", overtone " << n;
    }
    const auto [least, most] = std::ranges::minmax(force);
    EXPECT_NEAR(most - least, 2.0 * k_n * height,
                2.0 * k_n * height * std::pow(2.0 * pi * 10.0 / samples, 2) / 8.0 + 2e-4 * step_old)
        << "all of every ridge, between samples";
    for (std::size_t k = 0; k + static_cast<std::size_t>(samples) / 10 < force.size(); ++k) {
      ASSERT_NEAR(force[k], force[k + static_cast<std::size_t>(samples) / 10], 1e-9) << "period wavelength/v";
    }
  }
}

TEST(Texture, LongestStepSeesEveryWaveSixteenTimes) {
  const FieldEffects effects = installed(one_unit(k_n, k_t), {{"texture", {{"wavelength", wavelength}}}});
  ASSERT_EQ(effects.surface.size(), 1U);
  EXPECT_DOUBLE_EQ(effects.surface[0]->longest_step(10e-3), wavelength / (16.0 * 10e-3));
  EXPECT_EQ(effects.surface[0]->longest_step(0.0), std::numeric_limits<double>::infinity());
}

// Effects with bars and the changed parameters.
FieldEffects bars(const std::map<std::string, double>& changes) {
  const EffectKind& texture = kind_named("texture");
  Parameters parameters = defaults_of(texture.about.parameters);
  parameters.set("profile", std::string("bars"));
  for (const auto& [key, value] : changes) parameters.set(key, value);
  const PadLayout pad = one_unit(k_n, k_t);
  FieldEffects effects;
  texture.install(parameters, context_for(pad, true, 7, 0), effects);
  return effects;
}

TEST(Texture, BarsHaveTheWavesOfATrapezoid) {
  // A slide over 10 bars of 4 mm, 400 samples per bar, without friction. Wave n of a box of width D
  // L that is smoothed over the edge e L, from -h to h: h 4 sin(pi n D)/(pi n) sin(pi n e)/(pi n
  // e), and the mean h (2 D - 1). Sampling adds the waves 400 - n, 400 + n, 800 - n, ..., each at
  // most h 4/((pi n)^2 e): less than h 8/(pi^2 e 399^2) (1 + 1/4 + 1/9 + ...) = h 8.4e-6/e, 2.5e-4
  // h for e = 1/30 at n <= 7.
  constexpr int samples = 4000;
  for (const double duty : {0.5, 0.3}) {
    for (const double e : {1.0 / 10.0, 1.0 / 30.0}) {
      Field field(one_unit(k_n, k_t), Plane{}, {0.0, 0.0},
                  bars({{"height", height}, {"wavelength", wavelength}, {"duty", duty}, {"edge", e * wavelength}}));
      std::vector<double> force;
      for (int k = 0; k < 2 * samples; ++k) {
        field.step(at(40e-3 * k / samples, 0.0, -depth), 1.0 / samples);
        if (k >= samples) force.push_back(field.normal_force(0));
      }
      const double aliased = 8.4e-6 / e * k_n * height;
      EXPECT_NEAR(0.5 * amplitude(force, 0), k_n * (depth + height * (2.0 * duty - 1.0)), aliased);
      for (int n = 1; n <= 7; ++n) {
        const double wave = 4.0 * std::sin(pi * n * duty) / (pi * n) * std::sin(pi * n * e) / (pi * n * e);
        EXPECT_NEAR(amplitude(force, 10 * n), k_n * height * std::abs(wave), aliased) << "duty " << duty << ", wave " << n;
      }
      const auto [least, most] = std::ranges::minmax(force);
      EXPECT_NEAR(most - least, 2.0 * k_n * height, 1e-12);
      // The middle of the first bar is where a sine has its crest; that of the first gap is half a
      // wavelength further.
      EXPECT_DOUBLE_EQ(force[samples / 40], most);
      EXPECT_DOUBLE_EQ(force[3 * samples / 40], least);
    }
  }
}

TEST(Texture, WavinessAddsASineOfItsOwn) {
  // One wave of 40 mm under 10 bars: bin 1 of the spectrum has no contribution of the bars.
  Field field(one_unit(k_n, k_t), Plane{}, {0.0, 0.0},
              bars({{"height", height}, {"wavelength", wavelength}, {"waviness", 50e-6}, {"waviness_length", 40e-3}}));
  std::vector<double> force;
  for (int k = 0; k < 2000; ++k) {
    field.step(at(40e-3 * k / 1000, 0.0, -depth), 1e-3);
    if (k >= 1000) force.push_back(field.normal_force(0));
  }
  EXPECT_NEAR(amplitude(force, 1), k_n * 50e-6, 1e-12);
}

TEST(Texture, LongestStepSeesTheEdgesOfBars) {
  // A flank of 0.2 mm is half a wave of 0.4 mm; 16 samples of that wave at 10 mm/s are 2.5 ms
  // apart.
  EXPECT_NEAR(bars({{"edge", 0.2e-3}}).surface[0]->longest_step(10e-3), 2.5e-3, 1e-15);
}

TEST(Texture, RefusesEdgesThatDoNotFitAndBarsThatAreASine) {
  // duty 0.2 of 4 mm: a bar of 0.8 mm.
  EXPECT_THAT(refusal_of([] {
                bars({{"duty", 0.2}, {"edge", 0.9e-3}});
              }),
              refused_at("effects.texture.edge", {"0.9 mm", "0.8 mm"}));
  EXPECT_THAT(refusal_of([] {
                installed(one_unit(k_n, k_t), {{"texture", {{"duty", 0.3}}}});
              }),
              refused_at("effects.texture.profile", {"sine", "bars"}));
}

TEST(Texture, RidgesDoNotReachBeyondTheEdgeOfABox) {
  // A tip that hangs 1 um beside the box's top edge touches nothing, however high the ridges on the
  // top.
  const PadLayout pad = one_unit(k_n, k_t);
  Field field(pad, Box{{10e-3, 10e-3, 10e-3}}, {0.5, 0.5},
              installed(pad, {{"texture", {{"height", height}, {"wavelength", 40e-3}}}}));  // a crest at x = 10 mm
  field.step(at(10e-3 + 1e-6, 0.0, 10e-3 - depth), 1e-3);
  EXPECT_EQ(field.state(0), ElementState::detached);
}

TEST(Texture, RefusesCurvedSurfaces) {
  EXPECT_THAT(refusal_of([] {
                installed(one_unit(k_n, k_t), {{"texture", {}}}, false);
              }),
              refused_at("effects", {"texture", "plane", "box"}));
}

}  // namespace
}  // namespace slipbench::testing_effects::texture_test
