#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "tests/expect.h"
#include "tests/tools/train/small_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/files/project/project_file.h"
#include "tools/train/sequences.h"

namespace slipbench::testing {
namespace {

struct SequencesTest : SmallDatasetTest {
  std::string refusal(const std::string& file, const SequenceOptions& options = {}) {
    return refusal_of([&] { read_sequences(file, options); });
  }
};

TEST_F(SequencesTest, TakesEveryTenthSample) {
  const std::string file = dataset();
  const TrainingData data = read_sequences(file, {});
  const DatasetReader reader(file);
  EXPECT_EQ(data.command, reader.header().command);
  EXPECT_EQ(data.sensor, "pad");
  ASSERT_EQ(data.sequences.size(), 24U);
  const Sequence& sequence = data.sequences[3];
  const SensorRecord pad = reader.read_sensor(3, "pad");
  EXPECT_EQ(sequence.trial, 3U);
  ASSERT_EQ(sequence.time.size(), 40U);
  const auto displacement = std::find_if(pad.channels.begin(), pad.channels.end(),
                                         [](const SensorColumn& channel) { return channel.name == "displacement"; });
  for (std::size_t k = 0; k < 40; ++k) {
    EXPECT_DOUBLE_EQ(sequence.time[k], 0.01 * static_cast<double>(k));
    EXPECT_EQ(static_cast<std::uint8_t>(sequence.label[k]), pad.labels.state_paper[10 * k]);
    for (std::size_t i = 0; i < 27; ++i) EXPECT_EQ(sequence.displacements[k][i], displacement->values[270 * k + i]);
  }
}

TEST_F(SequencesTest, LabelsAndOnsetFollowTheRule) {
  const std::string file = dataset();
  const DatasetReader reader(file);
  const LabelRecord labels = reader.read_sensor(0, "pad").labels;
  const Sequence strict = read_sequences(file, {LabelRule::strict, {}}).sequences[0];
  const Sequence micro = read_sequences(file, {LabelRule::micro, {}}).sequences[0];
  const Sequence paper = read_sequences(file, {LabelRule::paper, {}}).sequences[0];
  for (std::size_t k = 0; k < strict.label.size(); ++k) {
    EXPECT_EQ(static_cast<std::uint8_t>(strict.label[k]), labels.state[10 * k]);
    EXPECT_EQ(static_cast<std::uint8_t>(micro.label[k]), labels.state_micro[10 * k]);
  }
  EXPECT_EQ(strict.onset, *std::min_element(labels.onset_time.begin(), labels.onset_time.end()));
  EXPECT_EQ(micro.onset, *std::min_element(labels.micro_onset_time.begin(), labels.micro_onset_time.end()));
  EXPECT_EQ(paper.onset, micro.onset);
  EXPECT_LT(micro.onset, strict.onset);
}

// In 0.1 s the pad moves by 0.1 or 1.6 mm, less and more than every pillar needs: with mu 0.5 and
// k_n/k_t 1.2/0.65 a tip compressed by 0.6 mm slips after 0.55 mm. Both stop; only a slipped pad
// stays slipped.
TEST_F(SequencesTest, WhatHasSlippedStaysSoAfterAStop) {
  const std::string file = dataset({{"sweep.motion.speed", "[1 mm/s, 16 mm/s]"},
                                    {"motion.stop", "0.1 s"},
                                    {"motion.acceleration", "10 m/s2"},
                                    {"sensors.pad.bristles", "1"}});
  const TrainingData paper = read_sequences(file, {LabelRule::paper, {}});
  const TrainingData has_slipped = read_sequences(file, {LabelRule::has_slipped, {}});
  for (std::size_t k = 0; k < paper.sequences.size(); ++k) {
    const Sequence& now = paper.sequences[k];
    const Sequence& ever = has_slipped.sequences[k];
    EXPECT_EQ(now.label.back(), PadState::non_slip);
    EXPECT_EQ(ever.label.back(), k < 12 ? PadState::non_slip : PadState::gross) << k;
    EXPECT_EQ(std::isnan(ever.onset), k < 12);
    if (k >= 12) {
      EXPECT_EQ(ever.onset, now.onset);
    }
    // Contact is never lost, so the label never falls, and is never below the current state's.
    EXPECT_TRUE(std::is_sorted(ever.label.begin(), ever.label.end()));
    EXPECT_TRUE(std::ranges::equal(ever.label, now.label, std::greater_equal<>()));
  }
}

// When the pad turns about its centre eight pillars are judged; the ninth never moves.
TEST_F(SequencesTest, TheCentrePillarIsLeftOutInTurns) {
  const std::string file = dataset({{"sweep.motion.speed", "[0 mm/s]"}, {"motion.rotation", "90 deg/s"}, {"duration", "0.6 s"}});
  for (const Sequence& sequence : read_sequences(file, {LabelRule::has_slipped, {}}).sequences) {
    EXPECT_EQ(sequence.label.back(), PadState::gross);
  }
}

TEST_F(SequencesTest, KnowTheMotion) {
  const TrainingData data = read_sequences(dataset(), {});
  for (const Sequence& sequence : data.sequences) {
    EXPECT_EQ(sequence.motion.speed, sequence.trial < 12 ? 0.004 : 0.016);
    EXPECT_EQ(sequence.motion.compression, 0.6e-3);
    // At rest until 0.2 s, the start of the motion; the first frame after that moves.
    for (std::size_t k = 0; k < sequence.time.size(); ++k) EXPECT_EQ(sequence.moving[k], k > 20 ? 1 : 0) << k;
  }
}

// With a faster sensor next to the pad the bodies have the faster sensor's times. It samples at
// k/100 s and 0.1 ms before; the motion begins between the two, so frame k is the first to move
// only if its own time is found among the bodies' times.
TEST_F(SequencesTest, MotionIsThatOfTheFramesOwnTime) {
  std::string starts;
  for (int k = 21; k <= 36; ++k) starts += (k == 21 ? "" : ", ") + std::to_string(10 * k - 1) + ".95 ms";
  const std::string file =
      dataset({{"time_step", "auto"},
               {"sensors", "{pad: {type: papillarray, rate: 1 kHz}, fast: {type: piezo_skin, rate: 10 kHz}}"},
               {"sweep", "{motion.start: [" + starts + "]}"}});
  const TrainingData data = read_sequences(file, {LabelRule::strict, "pad"});
  ASSERT_EQ(data.sequences.size(), 16U);
  for (std::size_t trial = 0; trial < 16; ++trial) {
    const std::vector<std::uint8_t>& moving = data.sequences[trial].moving;
    // Before the slide the pad is at rest along the surface.
    EXPECT_EQ(std::ranges::find(moving, 1) - moving.begin(), 21 + static_cast<std::ptrdiff_t>(trial));
  }
}

TEST_F(SequencesTest, OtherRatesOfTheDevice) {
  EXPECT_EQ(read_sequences(dataset({{"sensors.pad.rate", "500 Hz"}}), {}).sequences[0].time.size(), 40U);
  EXPECT_THAT(refusal(dataset({{"sensors.pad.rate", "250 Hz"}}, "b.h5")),
              AllOf(HasSubstr("b.h5: trial 0: sensor pad samples at 250 Hz"),
                    HasSubstr("a multiple of 100 Hz, the rate of the detector")));
}

// Two pads with 4 N at mu 0.12 hold 2 4 0.12 = 0.96 N of the 1.96 N that the box weighs: it slips
// when it is lifted.
TEST_F(SequencesTest, GraspIsOneCondition) {
  SweepOptions options;
  options.scene_path = project_file("scenes/grasp/learn.yaml");
  options.overrides = {{"friction.static", "0.12"}, {"grip.preset", "4 N"}, {"sweep", "{trials: 2}"}};
  options.jobs = 1;
  options.output = path("grasp.h5");
  run_sweep(options, program_catalogues());
  const TrainingData data = read_sequences(options.output, {LabelRule::micro, {}});
  const DatasetReader reader(options.output);
  ASSERT_EQ(data.sequences.size(), 2U);
  for (const Sequence& sequence : data.sequences) {
    const SensorRecord pad = reader.read_sensor(sequence.trial, "pad");
    EXPECT_EQ(sequence.time.size(), pad.time.size());
    EXPECT_EQ(condition_of(sequence.motion), condition_of({}));
    for (std::size_t k = 0; k < pad.time.size(); ++k)
      EXPECT_EQ(static_cast<std::uint8_t>(sequence.label[k]), pad.labels.state_micro[k]);
    EXPECT_FALSE(std::isnan(sequence.onset));
  }
}

TEST_F(SequencesTest, RefusalsNameFileAndChoice) {
  const std::string file = dataset();
  EXPECT_THAT(refusal(file, {LabelRule::paper, "finger"}), refused_at(file, {"finger", "pad"}));
  EXPECT_THAT(refusal(path("nowhere.h5")), HasSubstr("nowhere.h5"));
  EXPECT_THAT(refusal(path("scene.yaml")), HasSubstr("scene.yaml"));
}

// 20 conditions of 10 items each, mixed.
std::vector<std::size_t> mixed_conditions() {
  std::vector<std::size_t> conditions(200);
  for (std::size_t i = 0; i < conditions.size(); ++i) conditions[i] = 7 * i % 20;
  return conditions;
}

CommandedMotion moving(double speed, double rotation, double compression) { return {speed, rotation, compression}; }

TEST(Conditions, CompressionHasThePapersFourBands) {
  const auto band = [](double compression) { return condition_of(moving(1e-3, 0.0, compression)); };
  EXPECT_EQ(band(0.1e-3), band(0.75e-3));
  EXPECT_EQ(band(0.76e-3), band(1e-3));
  EXPECT_EQ(band(1.01e-3), band(1.125e-3));
  EXPECT_EQ(band(1.13e-3), band(5e-3));
  EXPECT_EQ((std::set{band(0.6e-3), band(0.9e-3), band(1.05e-3), band(1.3e-3)}.size()), 4U);
}

TEST(Conditions, ATurnCountsByTheSpeedOfACornerPillar) {
  // 2.9 deg/s at 9.9 mm are 0.501 mm/s.
  const double turn = 2.9 * std::numbers::pi / 180.0;
  EXPECT_EQ(condition_of(moving(0.0, -turn, 1e-3)), condition_of(moving(0.5e-3, 0.0, 1e-3)));
  EXPECT_EQ(condition_of(moving(0.5e-3, turn, 1e-3)), condition_of(moving(0.5e-3, 0.0, 1e-3)));
  std::set<std::size_t> different;
  for (const double speed : {0.0, 0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3, 16e-3})
    different.insert(condition_of(moving(speed, 0.0, 1e-3)));
  EXPECT_EQ(different.size(), 7U);
}

TEST(Bootstrap, EveryConditionTrainsAsOftenAsItHasItems) {
  const std::vector<std::size_t> conditions = mixed_conditions();
  for (std::size_t draw = 0; draw < draw_count; ++draw) {
    const BootstrapDraw drawn = bootstrap(conditions, 3, draw);
    std::map<std::size_t, std::size_t> times;
    for (std::size_t i = 0; i < conditions.size(); ++i) times[conditions[i]] += drawn.times[i];
    for (const auto& [condition, sum] : times) EXPECT_EQ(sum, 10U) << condition;
    EXPECT_EQ(drawn.training_size(), 200U);
  }
}

TEST(Bootstrap, LeavesTheShareOfTheClosedForm) {
  // Each of 10 items is missed by 10 draws with probability 0.9^10 = 0.34868. 300 draws of 200
  // items: the standard error is at most sqrt(0.349 0.651 / 60,000) = 0.0019.
  const std::vector<std::size_t> conditions = mixed_conditions();
  std::size_t tested = 0;
  for (std::size_t draw = 0; draw < 300; ++draw) tested += 200 - bootstrap(conditions, 1, draw).distinct();
  EXPECT_NEAR(static_cast<double>(tested) / 60000.0, std::pow(0.9, 10), 4 * 0.0019);
}

TEST(Bootstrap, AnOnlyItemOfItsConditionAlwaysTrains) {
  const std::vector<std::size_t> conditions{5, 1, 2};
  for (std::size_t draw = 0; draw < 10; ++draw)
    EXPECT_EQ(bootstrap(conditions, 1, draw).times, (std::vector<std::uint32_t>{1, 1, 1}));
}

TEST(Bootstrap, DependsOnSeedAndDrawAlone) {
  const std::vector<std::size_t> conditions = mixed_conditions();
  const std::vector<std::uint32_t> first = bootstrap(conditions, 1, 0).times;
  EXPECT_EQ(bootstrap(conditions, 1, 0).times, first);
  EXPECT_NE(bootstrap(conditions, 1, 1).times, first);
  EXPECT_NE(bootstrap(conditions, 2, 0).times, first);
}

}  // namespace

}  // namespace slipbench::testing
