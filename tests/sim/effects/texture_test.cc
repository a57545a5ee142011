// Ridges: what a slide over them makes of the normal force.
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "sim/core/error.h"
#include "tests/sim/effects/effect_rig.h"

namespace slipbench::testing_effects::texture_test {
namespace {

constexpr double k_n = 1000.0, k_t = 600.0, depth = 1e-3, height = 30e-6, wavelength = 4e-3, pi = std::numbers::pi;

TEST(Texture, NormalForceFollowsTheRidgesPointByPoint) {
  // f_z = k_n (d + h sin(2 pi s/wavelength)) with s the way across the ridges.
  for (const double angle : {0.0, 0.6, pi / 2.0}) {
    Field field = field_with(one_unit(k_n, k_t), {0.5, 0.5},
                             {{"texture", {{"height", height}, {"wavelength", wavelength}, {"angle", angle}}}});
    for (int k = 0; k < 300; ++k) {
      const double x = 37e-6 * k, y = -11e-6 * k;
      field.step(at(x, y, -depth), 1e-3);
      const double across = x * std::cos(angle) + y * std::sin(angle);
      EXPECT_NEAR(field.normal_force(0), k_n * (depth + height * std::sin(2.0 * pi * across / wavelength)), 1e-12);
    }
  }
}

TEST(Texture, SlideVibratesAtSpeedOverWavelength) {
  // 1 s at 1 kHz and v = 40 mm/s: 10 periods, bin 10 of the spectrum, amplitude k_n h = 30 mN; nothing elsewhere.
  const double v = 40e-3;
  const int samples = 1000;
  Field field = field_with(one_unit(k_n, k_t), {0.5, 0.5}, {{"texture", {{"height", height}, {"wavelength", wavelength}}}});
  std::vector<double> force;
  for (int k = 0; k < samples; ++k) {
    field.step(at(v * k / samples, 0.0, -depth), 1.0 / samples);
    force.push_back(field.normal_force(0));
  }
  for (int bin = 1; bin < 50; ++bin) {
    std::complex<double> sum = 0.0;
    for (int k = 0; k < samples; ++k) sum += force[static_cast<std::size_t>(k)] * std::polar(1.0, -2.0 * pi * bin * k / samples);
    EXPECT_NEAR(2.0 / samples * std::abs(sum), bin == 10 ? k_n * height : 0.0, 1e-12) << "bin " << bin;
  }
}

TEST(Texture, LongestStepSeesEveryWaveSixteenTimes) {
  const FieldEffects effects = installed(one_unit(k_n, k_t), {{"texture", {{"wavelength", wavelength}}}});
  ASSERT_EQ(effects.surface.size(), 1U);
  EXPECT_DOUBLE_EQ(effects.surface[0]->longest_step(10e-3), wavelength / (16.0 * 10e-3));
  EXPECT_EQ(effects.surface[0]->longest_step(0.0), std::numeric_limits<double>::infinity());
}

TEST(Texture, RidgesDoNotReachBeyondTheEdgeOfABox) {
  // A tip that hangs 1 um beside the box's top edge touches nothing, however high the ridges on the top are.
  const PadLayout pad = one_unit(k_n, k_t);
  Field field(pad, Box{{10e-3, 10e-3, 10e-3}}, {0.5, 0.5},
              installed(pad, {{"texture", {{"height", height}, {"wavelength", 40e-3}}}}));  // a crest at x = 10 mm
  field.step(at(10e-3 + 1e-6, 0.0, 10e-3 - depth), 1e-3);
  EXPECT_EQ(field.state(0), ElementState::detached);
}

TEST(Texture, RefusesCurvedSurfaces) {
  EXPECT_THROW(
      {
        try {
          installed(one_unit(k_n, k_t), {{"texture", {}}}, false);
        } catch (const InputError& error) {
          EXPECT_STREQ(error.what(), "effects: texture needs a flat surface; allowed shapes: plane, box");
          throw;
        }
      },
      InputError);
}

}  // namespace
}  // namespace slipbench::testing_effects::texture_test
