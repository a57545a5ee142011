// Spectrograms that the page draws: the right bin, the right times, and nothing where there is nothing to see.
#include "tools/program/report/report_parts.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace slipbench::report {
namespace {

// A nib pad's FL clusters: their difference is a sine of `frequency` [Hz] and amplitude 10 counts.
SensorRecord nib_record(double frequency, std::size_t samples) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "nib_pad";
  sensor.rate = 300.0;
  SensorColumn fl{"fl", "counts", {2}, {}, std::vector<double>{}};
  for (std::size_t row = 0; row < samples; ++row) {
    const double t = static_cast<double>(row) / sensor.rate;
    sensor.time.push_back(t);
    fl.time->push_back(t - 1e-3);
    const auto half = static_cast<float>(5.0 * std::sin(2.0 * std::numbers::pi * frequency * t));
    fl.values.insert(fl.values.end(), {half, -half});
  }
  sensor.channels.push_back(std::move(fl));
  return sensor;
}

TEST(Spectra, ASpectrogramHasARowAWindowAndItsBinsUpToTheHighest) {
  const Json spectra = spectra_of(nib_record(8.0, 300), 100000);
  ASSERT_EQ(spectra.size(), 1U);  // there is no FR
  const Json& fl = spectra[0];
  EXPECT_DOUBLE_EQ(fl["bin_hz"], 2.0);   // 1/0.5 s
  EXPECT_EQ(fl["data"]["columns"], 11);  // 0, 2, ... 20 Hz
  EXPECT_EQ(fl["data"]["rows"], 6);      // windows of 150 samples that end with sample 150, 180, ... 300
  EXPECT_EQ(fl["time"]["rows"], 6);
  // The largest magnitude is that at 8 Hz: the sine's amplitude over two, times the sum of Hamming's window, 0.54 * 150, but for what the line takes
  // (a few percent). `step` is 1/32767 of it.
  EXPECT_NEAR(fl["data"]["step"].get<double>() * 32767.0, 0.5 * 10.0 * 0.54 * 150.0, 0.05 * 405.0);
}

TEST(Spectra, FewerWindowsWhereThereIsNoRoom) {
  const Json spectra = spectra_of(nib_record(8.0, 300), 33);  // three windows of 11 bins
  ASSERT_EQ(spectra.size(), 1U);
  EXPECT_LE(spectra[0]["data"]["rows"].get<int>(), 3);
  EXPECT_GE(spectra[0]["data"]["rows"].get<int>(), 2);
}

TEST(Spectra, NoneOfWhatIsShorterThanAWindowOrOfAnotherSensor) {
  EXPECT_TRUE(spectra_of(nib_record(8.0, 149), 100000).empty());
  SensorRecord other = nib_record(8.0, 300);
  other.type = "papillarray";
  EXPECT_TRUE(spectra_of(other, 100000).empty());
}

}  // namespace
}  // namespace slipbench::report
