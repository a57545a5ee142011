// Sampling of a wave by the points of a unit, against the closed-form sum over a row of points.
#include "tools/trial/sweep/unit_sampling.h"

#include <cmath>
#include <numbers>

#include "tests/expect.h"

namespace slipbench::testing {
namespace {

constexpr double pitch = 1e-3;  // m

PadLayout square(std::size_t edge) {
  PadLayout layout;
  layout.units.push_back({0, edge * edge});
  for (std::size_t i = 0; i < edge * edge; ++i) {
    layout.elements.push_back(
        {.tip = {pitch * static_cast<double>(i % edge), pitch * static_cast<double>(i / edge), 0.0}, .k_normal = 2.0});
  }
  return layout;
}

// sin(n x)/(n sin x): n points, with x half the phase between neighbours.
double row(double n, double x) { return x == 0.0 ? 1.0 : std::abs(std::sin(n * x) / (n * std::sin(x))); }

TEST(UnitSampling, IsTheProductOfTwoRows) {
  const PadLayout layout = square(4);
  for (const double wavelength : {10e-3, 3.1e-3, 1.7e-3}) {
    for (const double angle : {0.0, 0.4, 1.2}) {
      const Eigen::Vector2d k = 2.0 * std::numbers::pi / wavelength * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const UnitSampling sampling = sampling_of(layout, layout.units[0], k);
      EXPECT_NEAR(sampling.gain, row(4.0, 0.5 * k.x() * pitch) * row(4.0, 0.5 * k.y() * pitch), 1e-12);
      EXPECT_NEAR(sampling.phase, std::max(k.x(), k.y()) * pitch, 1e-12);
      EXPECT_NEAR(sampling.spacing, pitch, 1e-15);
    }
  }
}

// For a wave of four pitches the fourth harmonic's wavelength is the pitch.
TEST(UnitSampling, FindsTheHarmonicThatIsInPhase) {
  const PadLayout layout = square(4);
  const UnitSampling sampling = sampling_of(layout, layout.units[0], {2.0 * std::numbers::pi / (4.0 * pitch), 0.0});
  EXPECT_NEAR(sampling.gain, 0.0, 1e-12);
  EXPECT_EQ(sampling.harmonic, 4U);
}

// For a wave of 4.4 pitches the fourth harmonic has the gain 0.81: the points are not in phase.
// The ninth, of 2.05 waves a pitch, is the first with more than 0.9.
TEST(UnitSampling, AHarmonicThatIsPartlyInPhaseDoesNotCount) {
  const PadLayout layout = square(4);
  const double k = 2.0 * std::numbers::pi / (4.4 * pitch);
  EXPECT_NEAR(row(4.0, 0.5 * 4.0 * k * pitch), 0.81, 0.005);
  EXPECT_NEAR(row(4.0, 0.5 * 9.0 * k * pitch), 0.95, 0.005);
  EXPECT_EQ(sampling_of(layout, layout.units[0], {k, 0.0}).harmonic, 9U);
}

TEST(UnitSampling, OfOnePlaceKeepsTheWave) {
  PadLayout layout;
  layout.units.push_back({0, 3});
  layout.elements.resize(3, {.k_normal = 1.0});
  const UnitSampling sampling = sampling_of(layout, layout.units[0], {1e4, 0.0});
  EXPECT_NEAR(sampling.gain, 1.0, 1e-12);
  EXPECT_EQ(sampling.phase, 0.0);
  EXPECT_EQ(sampling.spacing, 0.0);
}

}  // namespace
}  // namespace slipbench::testing
