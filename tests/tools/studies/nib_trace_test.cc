// A recorded trial, put together again as the detector saw it.
#include "tools/studies/nib_reconfigurable/nib_signature.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace slipbench::reproduce {
namespace {

// 100 samples at 300 Hz: an image every ninth, whose values are its number; the clusters count samples. Two nibs of 1 and 2 N, and a lever that
// goes 1 mm a sample.
TrialRecord recorded() {
  constexpr std::size_t samples = 100, images = samples / 9;
  TrialRecord record;
  SensorRecord& sensor = record.sensors.emplace_back();
  sensor.name = "pad";
  sensor.type = "nib_pad";
  sensor.rate = 300.0;
  sensor.channels = {{"si", "counts", {9, 4}, {}}, {"fl", "counts", {2}, {}}, {"fr", "counts", {2}, {}}};
  for (std::size_t image = 0; image < images; ++image)
    sensor.channels[0].values.insert(sensor.channels[0].values.end(), 36, static_cast<float>(image + 1));
  // An image is complete with each ninth sample.
  sensor.channels[0].time.emplace();
  for (std::size_t image = 0; image < images; ++image)
    sensor.channels[0].time->push_back(static_cast<double>(9 * (image + 1)) / 300.0 - 1e-3);
  BodyRecord& lever = record.bodies.emplace_back(BodyRecord{"lever", {}, {}});
  sensor.labels.k_normal = {1.0, 1.0};
  for (std::size_t k = 0; k < samples; ++k) {
    sensor.time.push_back(static_cast<double>(k + 1) / 300.0);
    for (const std::size_t channel : {1U, 2U})
      sensor.channels[channel].values.insert(sensor.channels[channel].values.end(), 2, static_cast<float>(k));
    sensor.labels.force.insert(sensor.labels.force.end(), {0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 2.0F});
    lever.pose.insert(lever.pose.end(), {0.0F, 1e-3F * static_cast<float>(k), 0.0F, 1.0F, 0.0F, 0.0F, 0.0F});
  }
  return record;
}

TEST(NibTrace, IsWhatTheDetectorSaw) {
  const NibTrace trace(recorded());
  ASSERT_EQ(trace.size(), 100u);
  EXPECT_EQ(trace.source().channels[0].every, 9u);
  const auto image = [&](std::size_t k) { return trace.frame(k).values[0]; };
  EXPECT_EQ(image(7), 0.0F);  // no image is complete
  EXPECT_EQ(image(8), 1.0F);
  EXPECT_EQ(image(16), 1.0F);
  EXPECT_EQ(image(17), 2.0F);
  EXPECT_EQ(trace.frame(50).values[36], 50.0F);
  EXPECT_EQ(trace.frame(50).values[39], 50.0F);
  EXPECT_EQ(trace.frame(50).time, 51.0 / 300.0);
  EXPECT_EQ(trace.normal(3), 3.0);
}

TEST(NibTrace, FindsTimesAndWays) {
  const NibTrace trace(recorded());
  EXPECT_EQ(trace.at(0.1), 29u);
  EXPECT_EQ(trace.at(9.0), 100u);
  EXPECT_EQ(trace.moved(10, 4.5e-3), 15u);
  EXPECT_EQ(trace.moved(10, 1.0), std::nullopt);
}

TEST(NibTrace, TakesNoOtherTrial) {
  TrialRecord other = recorded();
  other.bodies.clear();
  EXPECT_THROW(NibTrace{other}, std::logic_error);
}

}  // namespace
}  // namespace slipbench::reproduce
