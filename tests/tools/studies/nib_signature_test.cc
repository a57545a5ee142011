// Where the nib pad's signal below 8 Hz comes from, on the bench itself: the patches of friction, not its growth with speed.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/expect.h"
#include "tests/scenes.h"
#include "tools/program/run/run_trial.h"
#include "tools/studies/nib_reconfigurable/nib_signature.h"
#include "tools/studies/nib_reconfigurable/nib_tables.h"

namespace slipbench::reproduce::nib_signature_test {
namespace {

#ifdef SLIPBENCH_WITH_MUJOCO

// The slow release of the scene's own plate, paper pulled by 3 N, under a law of friction_laws().
std::optional<Signature> signature_under(const std::string& law) {
  Scene scene = parsed(shipped("nib_pad/release.yaml", {{"sweep", "{}"}}));
  std::ranges::find(friction_laws(), law, &FrictionLaw::name)->change(scene);
  return signature_of(scene, NibTrace(run_trial(scene, 0, Recording::full).record));
}

TEST(NibSignature, PatchesPutTheEnergyOfSlipBelow8HzAndTheRateLawAloneDoesNot) {
  const std::optional<Signature> patches = signature_under("scene"), smooth = signature_under("no_patches");
  // White noise of 1.2 counts a cluster, 1.7 of their difference, has 8 of its 150 Hz below 8 Hz: 0.053 of the energy, 0.39 counts rms. Patches
  // must make five times of either; without them little more than the noise is left.
  constexpr double noise_share = 8.0 / 150.0;
  const double noise_below = 1.2 * std::sqrt(2.0 * noise_share);
  ASSERT_TRUE(patches.has_value());
  EXPECT_GT(patches->share, 5.0 * noise_share);
  EXPECT_GT(patches->below, 5.0 * noise_below);
  ASSERT_TRUE(smooth.has_value());
  EXPECT_LT(smooth->share, 3.0 * noise_share);
}

#endif

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
  EXPECT_EQ(image(7), 1.0F);  // no image is complete: the first stands there
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

// Safe: before 6 mm. Gross: below the force that the pull requires; the other safe one is early.
TEST(ReleaseSummary, ErrorsAreThoseOfTheSafeRuns) {
  const std::vector<ReleaseRun> runs{
      {"paper", 4.0, 3.0, 1e-3}, {"paper", 4.0, 6.0, 3e-3}, {"paper", 4.0, 1.0, 7e-3}, {"felt", 1.0}};
  const ReleaseSummary paper = summary_of(runs, "paper");
  EXPECT_EQ(paper.runs, 3U);
  EXPECT_EQ(paper.safe, 2U);
  EXPECT_EQ(paper.early, 1U);
  EXPECT_DOUBLE_EQ(paper.error.mean, 1.5);
  EXPECT_DOUBLE_EQ(paper.gross_error.mean, 1.0);
  EXPECT_DOUBLE_EQ(paper.slip.mean, 2.0);
  EXPECT_EQ(summary_of(runs, "").runs, 4U);
  EXPECT_EQ(summary_of(runs, "felt").safe, 0U);
}

TEST(ReorientSummary, MediansLeaveOutWhatIsNone) {
  const double none = std::nan("");
  const ReorientRuns runs{{true, false, 0.1, 0.1, 5.0, {TurnEnd::standing, 0.2, 4.0}},
                          {false, false, 1.0, 0.3, 6.0, {TurnEnd::fell, 0.4, 3.0}},
                          {false, true, 1.5, 1.2, 7.0, {TurnEnd::lost, none, none}}};
  const ReorientSummary summary = summary_of(runs);
  EXPECT_EQ(summary.runs, 3U);
  EXPECT_EQ(summary.standing, 1U);
  EXPECT_EQ(summary.turned_up, 2U);
  EXPECT_EQ(summary.dropped, 1U);
  EXPECT_THAT(summary.ends, ElementsAre(1, 1, 0, 0, 1, 0, 0));
  EXPECT_DOUBLE_EQ(summary.tilt, 1.0);
  EXPECT_DOUBLE_EQ(summary.released_tilt, 0.3);
  EXPECT_DOUBLE_EQ(summary.held_by, 3.5);
  EXPECT_TRUE(std::isnan(summary_of({}).tilt));
}

}  // namespace

}  // namespace slipbench::reproduce::nib_signature_test
