// Features from frames: tare, touch, bands and refusals. Normal load, shear and curl of artificial
// images, and spectra, against closed forms: Hamming's transform, the subtracted line, bands and
// hops.
#include "detectors/nib/features.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tests/detectors/nib/nib_frames.h"
#include "tests/expect.h"

namespace slipbench::nib {
namespace {

FeatureReader reader(const FrameSource& source = nib_source(), const char* name = "", double value = 0.0) {
  Parameters parameters = defaults_of(feature_specs());
  if (*name != '\0') parameters.set(name, value);
  return {parameters, source, "a test"};
}

std::string refusal(const FrameSource& source, const char* name = "", double value = 0.0) {
  return refusal_of([&] { reader(source, name, value); });
}

// 300 ms are 90 frames. Taxels with changes W 1, N 7, E 3, S 2: normal 13, shear (2, 5), for each
// of nine.
TEST(Features, AreChangesAgainstTheUnloadedPad) {
  FeatureReader features = reader();
  NibFrames frames;
  for (int n = 0; n < 90; ++n) {
    EXPECT_FALSE(features.touching());
    features.update(frames.next());
  }
  features.update(frames.next());
  EXPECT_FALSE(features.touching());  // tared, without contact
  EXPECT_EQ(features.features().normal, 0.0);
  frames.load({1, 7, 3, 2});
  features.update(frames.next());
  EXPECT_TRUE(features.touching());
  EXPECT_EQ(features.features().normal, 9.0 * 13.0);
  EXPECT_EQ(features.features().shear, Eigen::Vector2d(9.0 * 2.0, 9.0 * 5.0));
  EXPECT_NEAR(features.features().curl, 0.0, 1e-15);
}

// If a channel is new every ninth sample, the first eight are not a whole image.
TEST(Features, WaitForTheFirstWholeImage) {
  FrameSource source = nib_source();
  source.channels[0].every = 9;
  FeatureReader features = reader(source);
  NibFrames frames;
  frames.load({-6960, -6960, -6960, -6960});
  for (int n = 0; n < 8; ++n) features.update(frames.next());
  frames.load({0, 0, 0, 0});
  for (int n = 0; n < 91; ++n) features.update(frames.next());
  EXPECT_EQ(features.features().normal, 0.0);
}

// A tone of A counts at 4 Hz: means of 0.25 N A/2 over 0 to 6 Hz and 0.115 N A/2 over 6 to 8 Hz
// (TakesTheMeanOfABand), N = 150. The line removes at most some percent of a cosine that is not
// even about the window's middle.
TEST(Features, HaveTheBandsOfBothModes) {
  FeatureReader features = reader();
  NibFrames frames;
  frames.vibrate(8.0, 4.0);
  int due = 0;
  for (int n = 0; n < 150; ++n) due += features.update(frames.next()) ? 1 : 0;
  EXPECT_EQ(due, 1);
  EXPECT_NEAR(features.features().fl, 0.25 * 75.0 * 8.0, 0.1 * 150.0);
  EXPECT_NEAR(features.features().fl_fast, 0.115 * 75.0 * 8.0, 0.1 * 69.0);
  EXPECT_NEAR(features.features().fr, 0.5 * features.features().fl, 1e-2);  // frames are floats: 6960 to 5e-4
  EXPECT_NEAR(features.features().fr_fast, 0.5 * features.features().fl_fast, 1e-2);
}

// Gains of 2 and 5 counts/N, taxels 7.6 mm apart. Nine taxels with N + E + S + W = 20: 90 N. The
// shear of each taxel is 5 counts, 1 N, and circulates about the centre: four at 7.6 mm, four at
// 7.6 sqrt 2 mm, and the centre's own. By the capacitor's law, 1/(1 - x), an electrode of C = 100
// counts whose gap closes by the share x reads 100 x/(1 - x) more. That must be inverted: otherwise
// 5 counts would be 5.3 and more.
TEST(Features, HandOnForcesAndTheMoment) {
  FrameSource source = nib_source();
  Parameters parameters = defaults_of(feature_specs());
  parameters.set("normal_gain", 2.0);
  parameters.set("shear_gain", 5.0);
  parameters.set("capacitance", 100.0);
  FeatureReader features(parameters, source, "a test");
  std::vector<float> values(40, 6960.0F);
  std::vector<double> outputs;
  features.update({0.0, values});
  features.hand_on(outputs);
  ASSERT_EQ(outputs.size(), handed_on().size());
  for (const double value : outputs) EXPECT_TRUE(std::isnan(value));
  for (int n = 1; n < 90; ++n) features.update({0.0, values});
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    const double x = static_cast<double>(taxel % 3) - 1.0, y = 1.0 - static_cast<double>(taxel / 3),
                 r = std::max(std::hypot(x, y), 1.0);
    const double shear_x = taxel == 4 ? 5.0 : -5.0 * y / r, shear_y = 5.0 * x / r;
    const double closed[] = {5.0 - shear_x / 2, 5.0 + shear_y / 2, 5.0 + shear_x / 2, 5.0 - shear_y / 2};  // 100 x
    for (std::size_t k = 0; k < electrodes; ++k) {
      values[electrodes * taxel + k] += static_cast<float>(closed[k] / (1.0 - closed[k] / 100.0));
    }
  }
  features.update({0.0, values});
  features.hand_on(outputs);
  EXPECT_TRUE(std::isnan(outputs[0]));  // no window is full yet
  EXPECT_NEAR(outputs[5], 90.0, 1e-3);
  EXPECT_NEAR(outputs[6], 1.0, 1e-3);  // the circulation cancels, and the centre's shear is left
  EXPECT_NEAR(outputs[7], 7.6e-3 * (4.0 + 4.0 * std::sqrt(2.0)), 1e-5);
}

TEST(Features, RefuseAnotherUnit) {
  FrameSource volts = nib_source();
  volts.channels[1].unit = "V";
  EXPECT_THAT(refusal(volts), mentions({"'fl'", "counts", "'V'"}));
}

TEST(Features, RefuseWhatTheyCannotBeMadeOf) {
  FrameSource other = nib_source();
  other.channels[1].name = "force";
  EXPECT_NE(refusal(other).find("needs the channel 'fl' of a nib_pad"), std::string::npos) << refusal(other);
  EXPECT_NE(refusal(nib_source(), "window", 0.501).find("must be a whole multiple"), std::string::npos);
  EXPECT_NE(refusal(nib_source(), "hop", 1e-3).find("must be a whole multiple"), std::string::npos);
  EXPECT_NE(refusal(nib_source(), "window", 0.3).find("wider than the band"), std::string::npos);
  EXPECT_NE(refusal(nib_source(10.0)).find("it must sample at least at twice"), std::string::npos);
}

// A field as a function of position, in taxel distances east and north of the centre.
ShearField field_of(const std::function<Eigen::Vector2d(double, double)>& shear) {
  ShearField field;
  for (std::size_t taxel = 0; taxel < taxels; ++taxel) {
    field.shear[taxel] = shear(static_cast<double>(taxel % 3) - 1.0, 1.0 - static_cast<double>(taxel / 3));
  }
  return field;
}

TEST(ShearField, SumsAndSubtractsElectrodes) {
  std::array<double, taxels * electrodes> change{};
  // Taxel 5, east of the centre: W 1, N 20, E 300, S 4000.
  change[20] = 1.0;
  change[21] = 20.0;
  change[22] = 300.0;
  change[23] = 4000.0;
  const ShearField field = shear_field(change);
  EXPECT_EQ(field.normal[5], 4321.0);
  EXPECT_EQ(field.shear[5], Eigen::Vector2d(299.0, -3980.0));
  EXPECT_EQ(field.total_normal(), 4321.0);
  EXPECT_EQ(field.total_shear(), Eigen::Vector2d(299.0, -3980.0));
}

TEST(Curl, OfATranslationIsNothing) {
  const ShearField field = field_of([](double, double) { return Eigen::Vector2d(30.0, -70.0); });
  EXPECT_NEAR(curl(field), 0.0, 1e-12);
  EXPECT_NEAR(normalised_curl(field), 0.0, 1e-13);
  EXPECT_EQ(normalised_curl(ShearField{}), 0.0);
}

// F = w (-y, x) has curl 2 w. Its vectors have the lengths w (four of them), sqrt(2) w (four) and
// 0.
TEST(Curl, OfARigidRotationIsTwiceItsRate) {
  for (const double w : {12.5, -3.0}) {
    const ShearField field = field_of([w](double x, double y) { return Eigen::Vector2d(-w * y, w * x); });
    EXPECT_NEAR(curl(field), 2.0 * w, 1e-12);
    EXPECT_NEAR(normalised_curl(field), std::copysign(9.0 / (2.0 + 2.0 * std::sqrt(2.0)), w), 1e-12);
  }
}

// A rotation about a centre that is off by c adds a translation, whose curl is zero: the counts are
// equal, their share falls.
TEST(Curl, OfARotationAboutAnotherPointIsTheSameInCounts) {
  const ShearField field = field_of([](double x, double y) { return Eigen::Vector2d(-5.0 * y, 5.0 * (x + 100.0)); });
  EXPECT_NEAR(curl(field), 10.0, 1e-10);
  EXPECT_NEAR(normalised_curl(field), 10.0 / 500.0, 1e-5);  // the mean length is 500 (1 + order 1e-4/3)
}

// A spread, F = (x, y), a shear without rotation, F = (y, x), and a saddle, F = (x, -y), have no
// curl.
TEST(Curl, SeesNoSpreadAndNoStrain) {
  EXPECT_NEAR(curl(field_of([](double x, double y) { return Eigen::Vector2d(x, y); })), 0.0, 1e-12);
  EXPECT_NEAR(curl(field_of([](double x, double y) { return Eigen::Vector2d(y, x); })), 0.0, 1e-12);
  EXPECT_NEAR(curl(field_of([](double x, double y) { return Eigen::Vector2d(x, -y); })), 0.0, 1e-12);
}

// Tangential shear at the corners alone: sum r F/6 over 4 F/9 is sqrt(2) 9/6, the maximum.
TEST(Curl, HasABound) {
  const ShearField field =
      field_of([](double x, double y) { return x != 0.0 && y != 0.0 ? Eigen::Vector2d(-y, x) : Eigen::Vector2d(0.0, 0.0); });
  EXPECT_NEAR(normalised_curl(field), 1.5 * std::sqrt(2.0), 1e-12);
}

constexpr std::size_t window = 150;
constexpr double rate = 300.0, size = 150.0;

// A cosine with `k` whole periods in the window, even about its middle: its mean and slope are
// zero, so that the line removes nothing.
std::vector<double> tone(double k, double amplitude) {
  std::vector<double> samples(window);
  for (std::size_t n = 0; n < window; ++n) {
    samples[n] = amplitude * std::cos(2.0 * std::numbers::pi * k * (static_cast<double>(n) - 0.5 * (size - 1.0)) / size);
  }
  return samples;
}

// The window's three lines in frequency are 0.54 and twice -0.23, so the tone's own bin has 0.54 N
// A/2, its neighbours 0.23 N A/2 and all others 0.
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
  // Each of N terms is rounded to one part in 2^53 of its inputs.
  for (const double magnitude : spectrum.magnitudes(line)) EXPECT_LT(magnitude, size * 7000.0 * 0x1p-52);
}

// A ramp under a tone changes nothing, because the ramp of a pull must not look like slip.
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
  for (int n = 0; n < 180; ++n) sliding.push(1e3 * n * n);  // older samples
  const std::vector<double> latest = tone(5.0, 7.0);
  for (const double sample : latest) sliding.push(sample);  // ends at 330, where a spectrum is due
  WindowSpectrum alone(window, rate);
  EXPECT_TRUE(std::ranges::equal(sliding.magnitudes(), alone.magnitudes(latest)));
}

// A tone at 4 Hz, bin 2: bins 0, 2, 4 and 6 Hz have 0, 0.23, 0.54 and 0.23 of N A/2, a mean of
// 0.25; 6 and 8 Hz have 0.23 and 0.
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
