// Spectra of signals with known spectra.

#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <vector>

#include "detectors/detector_kinds.h"
#include "detectors/spectral/spectral_features.h"
#include "sim/core/random.h"
#include "tests/expect.h"

namespace slipbench::spectral_test {
namespace {

constexpr double rate = 10e3;

double sine(double frequency, std::size_t n) {
  return std::sin(2.0 * std::numbers::pi * frequency * static_cast<double>(n) / rate);
}

TEST(RealFft, IsTheSumOfItsDefinition) {
  constexpr std::size_t size = 15;
  RealFft fft(size);
  RandomStream draws(1, 0, "fft");
  for (double& x : fft.input()) x = draws.normal();
  const auto spectrum = fft.transform();
  ASSERT_EQ(spectrum.size(), 8u);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    std::complex<double> sum = 0.0;
    for (std::size_t n = 0; n < size; ++n) {
      sum += fft.input()[n] * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k * n) / size);
    }
    EXPECT_NEAR(std::abs(spectrum[k] - sum), 0.0, 1e-13);
  }
}

TEST(SpectralFeatures, AreTwelveBinsFromFiftyToSixHundredHertz) {
  const SpectralFeatures features{SpectralLayout{}};
  ASSERT_EQ(features.bins(), 12u);
  EXPECT_DOUBLE_EQ(features.bin_width(), 50.0);
  EXPECT_DOUBLE_EQ(features.frequency(0), 50.0);
  EXPECT_DOUBLE_EQ(features.frequency(11), 600.0);
}

TEST(SpectralFeatures, AFrameEndsAfterTheWindowAndThenEveryHop) {
  SpectralFeatures features{SpectralLayout{}};
  std::vector<int> complete;
  for (int n = 1; n <= 450; ++n) {
    if (features.push(0.0F)) complete.push_back(n);
  }
  EXPECT_THAT(complete, ElementsAre(200, 300, 400));
}

TEST(SpectralFeatures, ASineInABinHasItsPowerThere) {
  // A^2/2 over 50 Hz in the bin of 250 Hz; the mean of 40 is removed.
  SpectralFeatures features{SpectralLayout{}};
  for (std::size_t n = 0; n < 500; ++n) features.push(static_cast<float>(40.0 + 3.0 * sine(250.0, n)));
  for (std::size_t b = 0; b < features.bins(); ++b) {
    EXPECT_NEAR(features.density()[b], b == 4 ? 4.5 / 50.0 : 0.0, 1e-7) << features.frequency(b);
  }
}

TEST(SpectralFeatures, SumToTheVarianceOfTheWindow) {
  // Parseval, with every bin above 0 kept.
  SpectralFeatures features{SpectralLayout{.low = 50.0, .high = 5000.0}};
  ASSERT_EQ(features.bins(), 100u);
  RandomStream draws(1, 0, "signal");
  std::vector<double> x(200);
  for (double& value : x) value = static_cast<double>(static_cast<float>(draws.normal(2.0, 1.0)));
  for (const double value : x) features.push(static_cast<float>(value));
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / 200.0;
  double variance = 0.0;
  for (const double value : x) variance += (value - mean) * (value - mean) / 200.0;
  const double power = std::accumulate(features.density().begin(), features.density().end(), 0.0) * features.bin_width();
  EXPECT_NEAR(power / variance, 1.0, 1e-12);
}

FrameSource source_at(double hertz, std::vector<Channel> channels) { return {"pad", "piezo_skin", hertz, std::move(channels)}; }
FrameSource skin() { return source_at(rate, {{"other", "", {3}, {}}, {"signal", "counts", {1}, {}}}); }

// Parameters of band_energy, with a threshold of 2.
Parameters with(std::initializer_list<std::pair<const char*, double>> values) {
  Parameters parameters = defaults_of(band_energy_detector().about.parameters);
  parameters.set("threshold", 2.0);
  for (const auto& [name, value] : values) parameters.set(name, value);
  return parameters;
}

// Returns the state after 300 samples of a sine of this rms.
PadState after(Detector& detector, double rms, double frequency = 200.0) {
  PadState state{};
  for (std::size_t n = 0; n < 300; ++n) {
    const std::vector<float> values{9.0F, 9.0F, 9.0F, static_cast<float>(std::numbers::sqrt2 * rms * sine(frequency, n))};
    state = detector.update({static_cast<double>(n) / rate, values}).state;
  }
  return state;
}

TEST(BandEnergy, SlipsFromTheThresholdUntilTheRelease) {
  const auto detector = band_energy_detector().create(with({{"release", 0.7}}), skin());
  EXPECT_EQ(after(*detector, 1.99), PadState::non_slip);
  EXPECT_EQ(after(*detector, 2.01), PadState::gross);
  EXPECT_EQ(after(*detector, 1.41), PadState::gross) << "above 0.7 times 2";
  EXPECT_EQ(after(*detector, 1.39), PadState::non_slip);
  EXPECT_EQ(after(*detector, 1.99), PadState::non_slip);
}

TEST(BandEnergy, HearsItsBandOnly) {
  const auto detector = band_energy_detector().create(with({{"low", 100.0}, {"high", 300.0}}), skin());
  EXPECT_EQ(after(*detector, 10.0, 50.0), PadState::non_slip);
  EXPECT_EQ(after(*detector, 10.0, 350.0), PadState::non_slip);
  EXPECT_EQ(after(*detector, 10.0, 300.0), PadState::gross);
}

TEST(BandEnergy, SaysNothingBeforeTheFirstWindow) {
  const auto detector = band_energy_detector().create(with({}), skin());
  const std::vector<float> values{0.0F, 0.0F, 0.0F, 100.0F};
  for (int n = 0; n < 199; ++n) ASSERT_EQ(detector->update({n / rate, values}).state, PadState::no_contact);
  EXPECT_EQ(detector->update({199 / rate, values}).state, PadState::non_slip) << "a constant has no power in the band";
}

std::string refusal(const Parameters& parameters, const FrameSource& source) {
  return refusal_of<SceneValueError>([&] { band_energy_detector().create(parameters, source); });
}

TEST(BandEnergy, RefusesWhatTheSensorCannotGive) {
  EXPECT_THAT(refusal(with({}), source_at(rate, {{"signal", "", {9, 3}, {}}})), mentions({"signal", "one value"}));
  EXPECT_THAT(refusal(with({{"window", 0.25e-3}}), skin()), mentions({"whole number of sampling times"}));
  EXPECT_THAT(refusal(with({{"hop", 0.0}}), skin()), mentions({"1,000,000"}));
  EXPECT_THAT(refusal(with({{"low", 60.0}, {"high", 90.0}}), skin()), mentions({"multiple", "50 Hz"}));
  EXPECT_THAT(refusal(with({{"low", 5100.0}, {"high", 6000.0}}), skin()), mentions({"half", "rate"}));
}

}  // namespace
}  // namespace slipbench::spectral_test
