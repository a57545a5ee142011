#include "tools/eval/replay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "tests/expect.h"
#include "tests/tools/eval/loop_scene.h"

namespace slipbench::eval::testing {
namespace {

// Pressed until 0.2 s, then slid.
std::string stage(const std::string& detector,
                  const std::string& sensors = "pad: {type: papillarray, rate: 1 kHz, electronics: typical}") {
  return fmt::format(
      "slipbench: 1\nduration: 0.6 s\nseed: 4\nmotion: {{kind: stage, gap: 0.1 mm, compression: 1 mm, approach_speed: 20 mm/s, start: 0.2 s, "
      "speed: 8 mm/s, acceleration: 1 m/s2}}\nsensors: {{{}}}\ndetector: {}\n",
      sensors, detector);
}

// Number of classes that the loop reports, so that equality is meaningful.
std::size_t classes(const TrialRecord& record) {
  const auto& said = record.control.value().detector_class;
  return std::set<std::uint8_t>(said.begin(), said.end()).size();
}

TEST(Replay, IsWhatTheLoopSaw) {
  for (const char* detector :
       {"{type: force_ratio}", "{type: force_ratio, ratio: 0.2, flip: 0.05}", "{type: shear_rate}", "{type: gst_hd}"}) {
    SCOPED_TRACE(detector);
    const Scene scene = parsed(stage(detector));
    const TrialRecord record = run_trial(scene, 3, Recording::full).record;
    EXPECT_GE(classes(record), 3U);
    expect_same_as_loop(scene, record);
  }
}

// The plugin reports samples of a skin of 10 kHz with a latency of one millisecond; it is updated
// at every sample of the pad, 1 kHz.
TEST(Replay, HearsAllSensorsAndWaitsForTheLatency) {
  const std::string sensors = "skin: {type: piezo_skin}, pad: {type: papillarray, rate: 1 kHz}";
  const TrialRecord bare = run_trial(parsed(stage("{type: force_ratio, sensor: pad}", sensors)), 0, Recording::full).record;
  const double threshold = 0.5 * static_cast<double>(std::ranges::max(bare.sensors[0].channels[0].values));
  const Scene scene =
      parsed(stage(fmt::format("{{type: plugin, library: {}/ears.so, sensor: pad, parameters: {{sensor: skin, threshold: {}}}}}",
                               SLIPBENCH_TEST_PLUGINS, threshold),
                   sensors));
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  EXPECT_GE(classes(record), 3U);
  const Replayed replayed = expect_same_as_loop(scene, record);
  EXPECT_EQ(replayed.seen.size(), record.sensors[1].time.size());
}

// Stores its input.
class Keeper final : public Detector {
 public:
  explicit Keeper(std::vector<std::vector<float>>& frames) : frames_(&frames) {}
  const SlipEstimate& update(const SensorFrame& frame) override {
    frames_->emplace_back(frame.values.begin(), frame.values.end());
    return estimate_ = {frame.time};
  }

 private:
  std::vector<std::vector<float>>* frames_;
  SlipEstimate estimate_;
};

// The slow channel is new in samples 2 and 5 (every third), with values read 0.01 s earlier; before
// its first row it has the first row's values.
TEST(Replay, ASlowChannelStandsStillBetweenItsRows) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.rate = 10.0;
  for (int row = 0; row < 7; ++row) sensor.time.push_back(0.1 * row);
  sensor.channels.push_back({"slow", "counts", {2}, {10.0F, 11.0F, 20.0F, 21.0F}, std::vector{0.19, 0.49}});
  sensor.channels.push_back({"fast", "counts", {}, {0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}});
  std::vector<std::vector<float>> frames;
  replay(std::make_unique<Keeper>(frames), std::span(&sensor, 1), 0);
  ASSERT_EQ(frames.size(), 7U);
  for (std::size_t row = 0; row < 7; ++row) {
    const float slow = row < 5 ? 10.0F : 20.0F;
    EXPECT_EQ(frames[row], (std::vector{slow, slow + 1.0F, static_cast<float>(row)})) << row;
  }
}

// Answers from its third frame on; before, its estimate has no frame.
class Late final : public Detector {
 public:
  const SlipEstimate& update(const SensorFrame& frame) override {
    if (++frames_ >= 3) estimate_ = {frame.time, 0.0, PadState::gross};
    return estimate_;
  }

 private:
  int frames_ = 0;
  SlipEstimate estimate_;
};

// A recording may begin at any time, such as a second before its trigger. No estimate
// is seen before the first one is available, at any start of the clock.
TEST(Replay, ARecordingMayBeginBeforeZero) {
  for (const double start : {-1.0, -1e-9, 0.0, 1.7e9}) {
    SensorRecord sensor;
    sensor.name = "pad";
    sensor.rate = 10.0;
    for (int row = 0; row < 5; ++row) sensor.time.push_back(start + 0.1 * row);
    sensor.channels.push_back({"force", "N", {}, {1.0F, 2.0F, 3.0F, 4.0F, 5.0F}});
    const Replayed replayed = replay(std::make_unique<Late>(), std::span(&sensor, 1), 0);
    EXPECT_THAT(replayed.seen,
                ElementsAre(PadState::no_contact, PadState::no_contact, PadState::gross, PadState::gross, PadState::gross));
    for (std::size_t row = 0; row < 5; ++row) {
      const double since = row < 2 ? -std::numeric_limits<double>::infinity() : sensor.time[row];
      EXPECT_EQ(replayed.seen_since[row], since) << start << ", row " << row;
    }
  }
}

TEST(Replay, SaysSinceWhenAnEstimateIsSeen) {
  const Scene scene = parsed(stage("{type: gst_hd, rate: 100 Hz}"));
  const TrialRecord record = run_trial(scene, 0, Recording::full).record;
  const Replayed replayed = expect_same_as_loop(scene, record);
  // Every tenth sample is classified, without latency.
  const std::vector<double>& time = record.sensors[0].time;
  EXPECT_EQ(replayed.seen_since[230], time[230]);
  EXPECT_EQ(replayed.seen_since[239], time[230]);
  EXPECT_TRUE(std::isnan(replayed.probability[230])) << "it has none";
}

// Updated at 10 Hz with samples at 20 Hz, it returns a probability that grows by `step`.
class Probable final : public Detector {
 public:
  explicit Probable(double step) : step_(step) {}
  const SlipEstimate& update(const SensorFrame& frame) override {
    if (samples_++ % 2 == 0) estimate_ = {frame.time, 0.0, PadState::non_slip, 0.5, {7.0, step_ * static_cast<double>(said_++)}};
    return estimate_;
  }
  [[nodiscard]] const std::vector<Feature>& features() const override {
    static const std::vector<Feature> two{{"other", "N"}, {probability_feature, "1"}};
    return two;
  }

 private:
  double step_;
  std::size_t samples_ = 0, said_ = 0;
  SlipEstimate estimate_;
};

TEST(Replay, TakesAProbabilityOnceAnEstimate) {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.rate = 20.0;
  sensor.time = {0.0, 0.05, 0.10, 0.15, 0.20};
  sensor.channels.push_back({"force", "N", {}, {1.0F, 2.0F, 3.0F, 4.0F, 5.0F}});
  const std::vector<double> said = replay(std::make_unique<Probable>(0.25), std::span(&sensor, 1), 0).probability;
  ASSERT_EQ(said.size(), 5U);
  for (const std::size_t row : {0U, 2U, 4U}) EXPECT_EQ(said[row], 0.125 * static_cast<double>(row));
  for (const std::size_t row : {1U, 3U}) EXPECT_TRUE(std::isnan(said[row])) << "said before";
  EXPECT_THROW(replay(std::make_unique<Probable>(0.75), std::span(&sensor, 1), 0), InputError) << "1.5 at 0.2 s exceeds 1";
}

// A recording at 100 Hz that has lost a sample, so that its mean rate is lower; without samples yet.
SensorRecord uneven_recording() {
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "skin";
  sensor.rate = 99.3;
  sensor.labels.truth = false;
  return sensor;
}

// `deviation` counts the frames of 0.5 s, here 50. Values of a straight line, 1 each 10 ms, with one
// sample lost: the line through the gap keeps the standard deviation sqrt((50^2 - 1)/12).
TEST(Replay, EvensOutALostSampleForDetectorsThatCountFrames) {
  SensorRecord sensor = uneven_recording();
  std::vector<float> values;
  for (int k = 0; k < 140; ++k) {
    if (k == 70) continue;
    sensor.time.push_back(0.01 * k);
    values.push_back(static_cast<float>(k));
  }
  sensor.channels.push_back({"signal", "counts", {1}, values});
  const double s = std::sqrt((50.0 * 50.0 - 1.0) / 12.0);
  const Replayed replayed = replay(chosen_detector("deviation", {{"threshold", "10"}}), std::span(&sensor, 1), 0, 1, 0);
  EXPECT_THAT(replayed.notice, mentions({"deviation", "100 Hz", "1 gap", "20 ms"}));
  ASSERT_EQ(replayed.probability.size(), sensor.time.size());
  for (std::size_t row = 60; row < sensor.time.size(); ++row) EXPECT_NEAR(replayed.probability[row], s / (s + 10.0), 1e-5) << row;
  EXPECT_THAT(refusal_of([&] { replay(chosen_detector("gst_hd", {}), std::span(&sensor, 1), 0, 1, 0); }),
              mentions({"sensor pad", "import --rate"}));
}

// Steps of 11 and 9 ms in turn, without sample 70: 69 of each are 100 Hz, though their median is 11
// ms. The values lie on a line over time, so frames 10 ms apart have the standard deviation above.
TEST(Replay, EvensOutStepsThatAlternate) {
  SensorRecord sensor = uneven_recording();
  std::vector<float> values;
  for (int k = 0; k <= 140; ++k) {
    if (k == 70) continue;
    sensor.time.push_back(0.01 * k + (k % 2 == 1 ? 0.001 : 0.0));
    values.push_back(static_cast<float>(100.0 * sensor.time.back()));
  }
  sensor.channels.push_back({"signal", "counts", {1}, values});
  const double s = std::sqrt((50.0 * 50.0 - 1.0) / 12.0);
  const Replayed replayed = replay(chosen_detector("deviation", {{"threshold", "10"}}), std::span(&sensor, 1), 0, 1, 0);
  EXPECT_EQ(replayed.notice, "resampled evenly at 100 Hz for deviation; 1 gap of at most 20 ms bridged");
  std::size_t estimates = 0;
  for (std::size_t row = 0; row < sensor.time.size(); ++row) {
    if (std::isnan(replayed.probability[row])) continue;
    EXPECT_NEAR(replayed.probability[row], s / (s + 10.0), 1e-5) << row;
    ++estimates;
  }
  EXPECT_GE(estimates, 45U) << "every second frame comes with the next one, in 90 rows with a whole window";
}

TEST(Replay, RefusesWhatTheLoopRefuses) {
  const Scene scene = parsed(stage("{type: force_ratio}"));
  TrialRecord record = run_trial(scene, 0, Recording::full).record;
  const Scene other = parsed(stage("{type: band_energy}", "pad: {type: piezo_skin}"));
  EXPECT_THROW(replay(*other.detector, record.sensors, 0, 1, 0), InputError);
  DetectorScene oracle = *scene.detector;
  oracle.type = "truth";
  EXPECT_THAT(refusal_of([&] { replay(oracle, record.sensors, 0, 1, 0); }), mentions({"oracle", "simulation"}));
  record.sensors[0].time.clear();
  EXPECT_THROW(replay(*scene.detector, record.sensors, 0, 1, 0), InputError);
}

}  // namespace
}  // namespace slipbench::eval::testing
