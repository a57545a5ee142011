// Frames of a made-up recording whose loudness and labels are known.
#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "sensors/piezo_skin/piezo_skin.h"
#include "tests/tools/base/record/test_records.h"

namespace slipbench::reproduce::piezo_frames_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t samples = 1000;  // nine frames of 200, one every 100

// 5 N on 20 N/mm at 20 mm/s.
Scene simulation() {
  Scene scene;
  SensorScene sensor;
  sensor.name = "pad";
  sensor.type = "piezo_skin";
  sensor.parameters = defaults_of(piezo_skin_sensor().about.parameters);
  scene.sensors.push_back(sensor);
  scene.motion.parameters.set("compression", 0.25e-3);
  scene.motion.parameters.set("speed", 20e-3);
  return scene;
}

// In contact from sample 150 on, slipping from 650 on but for the last; pressed until 300, slides from 600 on, at speed from 700 on.
TrialRecord recording(const std::function<double(double)>& signal) {
  TrialRecord record = slipbench::testing::make_record(0, samples);
  SensorRecord& sensor = record.sensors[0];
  sensor.type = "piezo_skin";
  sensor.rate = 10e3;
  sensor.channel_names = {"signal"};
  sensor.channels = {{"signal", "counts", {1}, std::vector<float>(samples)}};
  record.bodies = {{"pad", std::vector<float>(samples * 7), std::vector<float>(samples * 6)}};
  record.body_time.resize(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    sensor.time[i] = record.body_time[i] = 1e-4 * static_cast<double>(i);
    sensor.channels[0].values[i] = static_cast<float>(signal(sensor.time[i]));
    const bool slips = i >= 650 && i + 1 < samples;
    sensor.labels.state_micro[i] = i < 150 ? 0 : slips ? 3 : 1;
    sensor.labels.state_paper[i] = i < 150 ? 0 : i >= 600 ? 3 : 1;
    record.bodies[0].velocity[6 * i + 2] = i < 300 ? -5e-4F : 0.0F;
    record.bodies[0].velocity[6 * i] = i < 600 ? 0.0F : i < 700 ? 10e-3F : 20e-3F;
  }
  return record;
}

double power_of(const SkinFrame& frame, FrameSpectrum spectrum) { return frame.power[static_cast<std::size_t>(spectrum)]; }

TEST(SkinFrames, SayWhatHappensWithinThem) {
  const SkinRecording found = skin_recording(simulation(), recording([](double) { return 0.0; }));
  EXPECT_DOUBLE_EQ(found.force, 5.0);
  EXPECT_DOUBLE_EQ(found.speed, 20e-3);
  ASSERT_EQ(found.frames.size(), 9u);
  // Frame k has the samples 100 k to 100 k + 199.
  const auto& f = found.frames;
  EXPECT_TRUE(f[0].contact && f[0].pressed && !f[0].one_label) << "it touches within it";
  EXPECT_TRUE(f[1].pressed && !f[1].one_label && f[2].pressed && f[2].one_label);
  EXPECT_TRUE(f[3].contact && !f[3].pressed && !f[3].slid && f[3].one_label);
  EXPECT_NEAR(f[3].still, (499.0 - 299.0) * 1e-4, 1e-12);
  EXPECT_TRUE(!f[4].slid && f[5].slid && f[5].slips && f[5].slips_by_position && f[5].slipped && !f[5].one_label);
  EXPECT_EQ(f[5].still, 0.0);
  EXPECT_FALSE(f[5].at_speed) << "10 of 20 mm/s at sample 699";
  EXPECT_TRUE(f[6].at_speed && f[7].slips && f[7].one_label);
  EXPECT_TRUE(!f[8].slips && f[8].slipped && f[8].contact && f[8].slips_by_position && !f[8].one_label) << "it sticks at the end";
}

// A line of amplitude 4 in the middle of a bin has the power 4^2/2 however it is tapered: its density spreads over Hann's three bins, all within
// the band, and is divided by the taper's own power. A straight line takes nothing from it worth speaking of: it is at bin 6, where a line's share is small.
TEST(SkinFrames, MeasureTheBand) {
  const auto tone =
      skin_recording(simulation(), recording([](double t) { return 100.0 + 4.0 * std::cos(2.0 * pi * 300.0 * t); }));
  for (const SkinFrame& frame : tone.frames) {
    EXPECT_NEAR(power_of(frame, FrameSpectrum::plain), 8.0, 1e-3);
    EXPECT_NEAR(power_of(frame, FrameSpectrum::hann), 8.0, 1e-3);
    EXPECT_NEAR(power_of(frame, FrameSpectrum::detrended), 8.0, 0.05);
  }
}

// A ramp of 1,000 counts/s rises by D = 20 counts over a frame. Its harmonics k have the rms D/(sqrt(2) pi k): over 12 bins the power
// D^2/(2 pi^2) sum 1/k^2. Hann's taper makes y_k = x_k/2 - (x_k-1 + x_k+1)/4 of the harmonics x_k = 1/k, x_0 = 0: 3/8 of the first and
// -1/(2 k (k^2 - 1)) of the others, over the taper's power 3/8: a quarter is left, in the first bin. Without its straight line nothing is. (Of
// samples instead of a line the harmonics are 1/sin instead of 1/angle: at most pi 12/200, which is 0.6 % of the last.)
TEST(SkinFrames, OfARampDependOnTheSpectrum) {
  const auto ramp = skin_recording(simulation(), recording([](double t) { return 1000.0 * t; }));
  double plain = 0.0, hann = 0.0;
  for (int k = 1; k <= 12; ++k) {
    plain += 1.0 / (k * k);
    hann += std::pow(k == 1 ? 3.0 / 8.0 : 1.0 / (2.0 * k * (k * k - 1.0)), 2) / (3.0 / 8.0);
  }
  const double scale = 400.0 / (2.0 * pi * pi);
  for (const SkinFrame& frame : ramp.frames) {
    EXPECT_NEAR(power_of(frame, FrameSpectrum::plain), scale * plain, 0.01 * scale * plain);
    EXPECT_LT(power_of(frame, FrameSpectrum::detrended), 1e-6 * scale);
    EXPECT_NEAR(power_of(frame, FrameSpectrum::hann), scale * hann, 0.01 * scale * hann);
  }
}

}  // namespace
}  // namespace slipbench::reproduce::piezo_frames_test
