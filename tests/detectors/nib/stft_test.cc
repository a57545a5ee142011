// Spectra against closed forms: Hamming's transform, the line that is taken away, bands and hops.
#include "detectors/nib/features.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace slipbench::nib {
namespace {

constexpr std::size_t window = 150;
constexpr double rate = 300.0, size = 150.0;

// A cosine with `k` whole periods in the window, even about its middle: its mean and its slope are zero, so that the line takes nothing.
std::vector<double> tone(double k, double amplitude) {
  std::vector<double> samples(window);
  for (std::size_t n = 0; n < window; ++n) {
    samples[n] = amplitude * std::cos(2.0 * std::numbers::pi * k * (static_cast<double>(n) - 0.5 * (size - 1.0)) / size);
  }
  return samples;
}

// The window's three lines in frequency are 0.54 and twice -0.23, so the tone's own bin has 0.54 N A/2, its neighbours 0.23 N A/2 and
// all others nothing.
TEST(WindowSpectrum, OfAToneHasHammingsCoherentGain) {
  WindowSpectrum spectrum(window, rate);
  EXPECT_EQ(spectrum.bin_width(), 2.0);
  const double amplitude = 7.0, whole = 0.5 * size * amplitude;
  const std::span<const double> magnitudes = spectrum.magnitudes(tone(5.0, amplitude));
  ASSERT_EQ(magnitudes.size(), 76u);
  for (std::size_t k = 0; k < magnitudes.size(); ++k) {
    const double expected = k == 5 ? 0.54 * whole : k == 4 || k == 6 ? 0.23 * whole : 0.0;
    EXPECT_NEAR(magnitudes[k], expected, 1e-12 * whole) << k;
  }
}

TEST(WindowSpectrum, OfAStraightLineIsNothing) {
  WindowSpectrum spectrum(window, rate);
  std::vector<double> line(window);
  for (std::size_t n = 0; n < window; ++n) line[n] = 6960.0 - 2.5 * static_cast<double>(n);
  // Each of N terms is rounded to a part in 2^53 of what it was computed from.
  for (const double magnitude : spectrum.magnitudes(line)) EXPECT_LT(magnitude, size * 7000.0 * 0x1p-52);
}

// A ramp under a tone changes nothing: the ramp of a pull must not look like slip.
TEST(WindowSpectrum, SeesAToneThroughARamp) {
  WindowSpectrum spectrum(window, rate);
  std::vector<double> samples = tone(2.0, 3.0);
  for (std::size_t n = 0; n < window; ++n) samples[n] += 100.0 + 4.0 * static_cast<double>(n);
  const std::span<const double> magnitudes = spectrum.magnitudes(samples);
  EXPECT_NEAR(magnitudes[2], 0.54 * 0.5 * size * 3.0, 1e-9);
  EXPECT_NEAR(magnitudes[4], 0.0, 1e-9);
}

TEST(WindowSpectrum, RefusesAnotherLength) {
  WindowSpectrum spectrum(window, rate);
  EXPECT_THROW(spectrum.magnitudes(std::vector<double>(window + 1)), std::invalid_argument);
  EXPECT_THROW(WindowSpectrum(3, rate), std::invalid_argument);
}

TEST(SlidingSpectrum, IsDueWhenTheWindowIsFullAndThenEveryHop) {
  SlidingSpectrum sliding(window, 30, rate);
  std::vector<int> due;
  for (int n = 1; n <= 240; ++n) {
    if (sliding.push(0.0)) due.push_back(n);
  }
  EXPECT_EQ(due, (std::vector<int>{150, 180, 210, 240}));
}

TEST(SlidingSpectrum, IsThatOfTheLatestWindow) {
  SlidingSpectrum sliding(window, 30, rate);
  for (int n = 0; n < 180; ++n) sliding.push(1e3 * n * n);  // what has gone by
  const std::vector<double> latest = tone(5.0, 7.0);
  for (const double sample : latest) sliding.push(sample);  // ends at 330, where a spectrum is due
  WindowSpectrum alone(window, rate);
  EXPECT_TRUE(std::ranges::equal(sliding.magnitudes(), alone.magnitudes(latest)));
}

// A tone at 4 Hz, bin 2: bins 0, 2, 4 and 6 Hz have 0, 0.23, 0.54 and 0.23 of N A/2, a mean of 0.25; 6 and 8 Hz have 0.23 and 0.
TEST(SlidingSpectrum, TakesTheMeanOfABand) {
  SlidingSpectrum sliding(window, 30, rate);
  EXPECT_EQ(sliding.band_mean(0.0, 6.0), 0.0);
  for (const double sample : tone(2.0, 8.0)) sliding.push(sample);
  const double whole = 0.5 * size * 8.0;
  EXPECT_NEAR(sliding.band_mean(0.0, 6.0), 0.25 * whole, 1e-9);
  EXPECT_NEAR(sliding.band_mean(6.0, 8.0), 0.115 * whole, 1e-9);
  EXPECT_NEAR(sliding.band_mean(4.0, 4.0), 0.54 * whole, 1e-9);
  EXPECT_THROW((void)sliding.band_mean(4.1, 5.9), std::invalid_argument);
  EXPECT_THROW((void)sliding.band_mean(0.0, 152.0), std::invalid_argument);
  EXPECT_THROW((void)sliding.band_mean(-2.0, 6.0), std::invalid_argument);
}

}  // namespace
}  // namespace slipbench::nib
