#include "tools/program/learn/frames.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/core/error.h"

namespace slipbench::learn::frames_test {
namespace {

using ::testing::ElementsAre;

constexpr double rate = 10e3;
constexpr double rounding = 1.0 / 12.0 / 5000.0;  // counts^2/Hz

SensorRecord recording(std::size_t samples) {
  SensorRecord sensor;
  sensor.name = "skin";
  sensor.type = "piezo_skin";
  sensor.rate = rate;
  sensor.channels.push_back({"signal", "1", {1}, std::vector<float>(samples, 7.0F)});
  for (std::size_t i = 0; i < samples; ++i) sensor.time.push_back(static_cast<double>(i) / rate);
  sensor.labels.state.assign(samples, 1);  // by strict nothing ever slips
  sensor.labels.state_micro.assign(samples, 1);
  sensor.labels.state_paper.assign(samples, 1);
  return sensor;
}

// A sine of 300 Hz has six whole periods in a frame: its variance a^2/2 is all in the bin of 300 Hz, 50 Hz wide.
TEST(LogSpectrogram, OfASineIsOneBin) {
  std::vector<float> signal(400);
  constexpr double amplitude = 40.0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    signal[i] = static_cast<float>(1000.0 + amplitude * std::sin(2.0 * std::numbers::pi * 300.0 * static_cast<double>(i) / rate));
  }
  const std::vector<float> features = log_spectrogram(signal, {});
  ASSERT_EQ(features.size(), 3U * 12U);  // frames end with samples 199, 299, 399
  for (std::size_t i = 0; i < features.size(); ++i) {
    const double expected = i % 12 == 5 ? std::log10(amplitude * amplitude / 2.0 / 50.0 + rounding) : std::log10(rounding);
    EXPECT_NEAR(features[i], expected, 1e-3) << i;  // float32 samples of 1000 counts are rounded by 3e-5
  }
}

// Slip begins with sample 250 in truth and with 300 by the position: the frames that end with 299 and 399.
TEST(SpectralSequence, LabelsAFrameByItsEnd) {
  SensorRecord sensor = recording(450);
  std::fill(sensor.labels.state_micro.begin() + 250, sensor.labels.state_micro.end(), std::uint8_t{3});
  sensor.labels.state_micro[399] = 2;  // incipient counts as well
  std::fill(sensor.labels.state_paper.begin() + 300, sensor.labels.state_paper.end(), std::uint8_t{3});
  const FrameSequence sequence = spectral_sequence(sensor, LabelRule::truth);
  EXPECT_THAT(sequence.slip, ElementsAre(0, 1, 1));
  EXPECT_EQ(sequence.features.size(), 36U);
  EXPECT_FLOAT_EQ(sequence.features[0], static_cast<float>(std::log10(rounding)));  // a constant is silence
  EXPECT_THAT(spectral_sequence(sensor, LabelRule::paper).slip, ElementsAre(0, 0, 1));
}

TEST(SpectralSequence, OtherSensorsAreRefused) {
  SensorRecord slow = recording(450);
  slow.rate = 1000.0;
  EXPECT_THROW(spectral_sequence(slow, LabelRule::truth), InputError);
  EXPECT_THROW(spectral_sequence(recording(199), LabelRule::truth), InputError);
  SensorRecord two = recording(450);
  two.channels.push_back(two.channels[0]);
  EXPECT_THROW(spectral_sequence(two, LabelRule::truth), InputError);
}

// Of 0 and 2 the mean is 1 and the standard deviation 1, so that 4 becomes 3. The second feature is always 5.
TEST(Standardiser, IsThatOfItsFrames) {
  const std::vector<FrameSequence> learnt{{{0.0F, 5.0F}, {0}}, {{2.0F, 5.0F}, {1}}};
  const Standardiser standardise(learnt, 2);
  EXPECT_THAT(standardise({{4.0F, 6.0F, 1.0F, 5.0F}, {0, 0}}).features, ElementsAre(3.0F, 1.0F, 0.0F, 0.0F));
  EXPECT_THROW(Standardiser(std::span<const FrameSequence>{}, 2), std::invalid_argument);
}

}  // namespace
}  // namespace slipbench::learn::frames_test
