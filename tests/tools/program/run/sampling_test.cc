// A multiplexed sensor: several readings make a sample, and a channel may be slower than the samples.
#include "tools/program/run/sampling.h"

#include <array>
#include <memory>
#include <vector>

#include "sim/simulation/stage_simulation.h"
#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/program/catalogue/sensor_catalogue.h"
#include "tools/program/run/recorder.h"
#include "tools/program/run/run_trial.h"

namespace slipbench::sampling_test {
namespace {

TEST(Sampling, ASampleIsCompleteWithTheLastOfItsReadings) {
  const Sampling sampling{.stride = 2, .scans = 3};
  std::vector<std::size_t> reads, completes;
  for (std::size_t tick = 0; tick < 14; ++tick) {
    if (sampling.reads_at(tick)) reads.push_back(tick);
    if (sampling.completes_at(tick)) completes.push_back(tick);
  }
  EXPECT_THAT(reads, ElementsAre(0, 2, 4, 6, 8, 10, 12));
  EXPECT_THAT(completes, ElementsAre(4, 10));
  EXPECT_EQ(sampling.samples(14), 2U);  // readings at 12 and after would be the third sample's
  EXPECT_EQ(sampling.samples(4), 0U);   // tick 4 is not reached
  EXPECT_EQ(sampling.samples(5), 1U);
}

TEST(Sampling, WithOneReadingASampleTheFirstIsAtTheBeginning) {
  const Sampling sampling{.stride = 4, .scans = 1};
  EXPECT_TRUE(sampling.completes_at(0));
  EXPECT_EQ(sampling.samples(1), 1U);
  EXPECT_EQ(sampling.samples(5), 2U);
}

// 250 samples a second of four readings; the values are the number of the latest reading, and that of the latest sample.
class Multiplexed final : public Sensor {
 public:
  explicit Multiplexed(PadLayout layout) : layout_(std::move(layout)) {
    channels_ = {{.name = "reading", .unit = "1", .shape = {1}, .channel_names = {"R"}},
                 {.name = "image", .unit = "1", .shape = {1}, .channel_names = {"I"}, .every = 3, .age = 2e-3}};
  }
  [[nodiscard]] const PadLayout& layout() const override { return layout_; }
  [[nodiscard]] double rate() const override { return 250.0; }
  [[nodiscard]] std::size_t scans() const override { return 4; }
  [[nodiscard]] const std::vector<Channel>& channels() const override { return channels_; }
  const SensorFrame& measure(const ContactFrame& truth) override {
    values_ = {static_cast<float>(reads_), static_cast<float>(reads_ / 4)};
    ++reads_;
    frame_ = {truth.time, values_};
    return frame_;
  }
  [[nodiscard]] PadState paper_label(const ContactFrame& truth, bool) const override { return truth.state; }

 private:
  PadLayout layout_;
  std::vector<Channel> channels_;
  std::array<float, 2> values_{};
  int reads_ = 0;
  SensorFrame frame_;
};

// The shipped press-and-slide, cut to `duration`, at steps of 1 ms.
Scene scene_of(const std::string& duration) { return stage_scene({{"duration", duration}}); }

TrialRecord record_of(const Scene& scene) {
  std::vector<std::unique_ptr<Sensor>> sensors;
  sensors.push_back(std::make_unique<Multiplexed>(make_sensor(scene.sensors.front(), scene.seed, 0)->layout()));
  const PadLayout* pad = &sensors.front()->layout();
  const double readings = 1000.0;
  StageSimulation simulation(scene, {&pad, 1}, {&readings, 1}, 0);
  Sampler sampler(scene, sensors, simulation);
  TrialRecord record = new_record(scene, sensors, simulation, 0);
  Recorder recorder(scene, sensors, simulation, nullptr, sampler, max_record_bytes, record);
  while (!sampler.finished()) {
    simulation.step();
    recorder.record(sampler.measure(), ControlLoop());
  }
  return record;
}

TEST(Sampling, TheRecordHoldsWholeSamplesAndASlowChannelItsOwnTime) {
  const TrialRecord record = record_of(scene_of("30 ms"));
  const SensorRecord& sensor = record.sensors.front();
  // 30 readings at 0 to 29 ms: seven samples, complete at 3, 7, ... 27 ms, and of those two images, with the third and the sixth.
  ASSERT_EQ(sensor.time.size(), 7U);
  EXPECT_EQ(record.num_samples(), 7U);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_NEAR(sensor.time[k], 3e-3 + 4e-3 * static_cast<double>(k), 1e-12);
    EXPECT_EQ(sensor.time[k], record.body_time[k]);
    EXPECT_EQ(sensor.channels[0].values[k], 3.0F + 4.0F * static_cast<float>(k));
  }
  EXPECT_FALSE(sensor.channels[0].time.has_value());
  ASSERT_TRUE(sensor.channels[1].time.has_value());
  EXPECT_THAT(sensor.channels[1].values, ElementsAre(2.0F, 5.0F));
  EXPECT_EQ(sensor.labels.state.size(), 7U);
  ASSERT_EQ(sensor.channels[1].time->size(), 2U);
  EXPECT_NEAR(sensor.channels[1].time->at(0), 11e-3 - 2e-3, 1e-12);  // complete at 11 ms, read 2 ms before
  EXPECT_NEAR(sensor.channels[1].time->at(1), 23e-3 - 2e-3, 1e-12);
}

TEST(Sampling, ATrialWithoutAWholeSampleIsRefused) {
  // Readings at 0, 1 and 2 ms.
  EXPECT_THAT(refusal_of<SceneValueError>([&] { record_of(scene_of("3 ms")); }), HasSubstr("4 ms or longer"));
}

TEST(Sampling, ASensorBetweenItsUnitsNeedsASimulationThatTellsOfElements) {
  const Scene scene = scene_of("30 ms");
  PadLayout with = make_sensor(scene.sensors.front(), scene.seed, 0)->layout(), without = with;
  with.element_truth = true;
  std::vector<std::unique_ptr<Sensor>> sensors;
  sensors.push_back(std::make_unique<Multiplexed>(with));
  const double readings = 1000.0;
  const auto sample_on = [&](const PadLayout* pad) {
    const StageSimulation simulation(scene, {&pad, 1}, {&readings, 1}, 0);
    const Sampler sampler(scene, sensors, simulation);
  };
  EXPECT_NO_THROW(sample_on(&with));
  EXPECT_THROW(sample_on(&without), std::logic_error);
}

}  // namespace
}  // namespace slipbench::sampling_test
