// Examples and figures of the networks' tables, of plain values.
#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <cmath>

#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::reproduce::piezo_networks_test {
namespace {

using train::LabelRule;
using train::masked;

// Three frames of one value, the last slips; by the position the second does, too.
PiezoRecording recording() {
  PiezoRecording one;
  one.motors_only = false;
  one.inputs = {{{1.0F, 2.0F, 3.0F}, {0, 0, 1}, {0, 1, 1}}};
  one.time = {0.02, 0.03, 0.04};
  one.contact = {0, 1, 1};
  one.motors = {0.5F, 0.0F, 0.25F};
  return one;
}

NetworkRow row_of(train::Layers layers) {
  layers.emplace_back(train::Linear{2});
  return {.name = "one", .text = "one", .shape = {1, std::move(layers)}};
}

TEST(Examples, OfOneFrameAreTheFrames) {
  const std::vector<train::FoldExample> examples = examples_of({recording()}, row_of({}), LabelRule::paper);
  ASSERT_EQ(examples.size(), 1U);
  EXPECT_EQ(examples[0].group, with_slip);
  EXPECT_THAT(examples[0].frames.features, ElementsAre(1.0F, 2.0F, 3.0F));
  EXPECT_THAT(examples[0].frames.label, ElementsAre(0, 1, 1));
}

// A kernel of 3 looks back to 2 frames before the first.
TEST(Examples, LookBackToTheFirstFrame) {
  const auto examples = examples_of({recording()}, row_of({train::Conv1d{1, 3}}), LabelRule::micro);
  EXPECT_THAT(examples[0].frames.features, ElementsAre(1.0F, 1.0F, 1.0F, 2.0F, 3.0F));
  EXPECT_THAT(examples[0].frames.label, ElementsAre(masked, masked, 0, 0, 1));
}

// Of three frames one is later: an answer names the middle one. The answer after the k-th frame stands at k + 2, the label of k - 1 with it.
TEST(Examples, ThatHaveSeenLaterFramesNameEarlierOnes) {
  NetworkRow row = row_of({train::Conv1d{1, 3}});
  row.later = 1;
  const auto examples = examples_of({recording()}, row, LabelRule::micro);
  EXPECT_THAT(examples[0].frames.features, ElementsAre(1.0F, 1.0F, 2.0F, 3.0F, 3.0F));
  EXPECT_THAT(examples[0].frames.label, ElementsAre(masked, masked, 0, 0, 1));
}

TEST(Examples, OfAShortcutAreWhatItIsTold) {
  NetworkRow row = row_of({});
  row.told = {.time = true, .contact = true, .motors = true, .kind = true};
  row.shape.inputs = row.told.values();
  const auto examples = examples_of({recording()}, row, LabelRule::micro);
  EXPECT_THAT(examples[0].frames.features,
              ElementsAre(0.02F, 0.0F, 0.5F, 0.0F, 0.03F, 1.0F, 0.0F, 0.0F, 0.04F, 1.0F, 0.25F, 0.0F));
  EXPECT_THAT(examples[0].frames.label, ElementsAre(0, 0, 1));
}

// Two folds. With contact: all right, and half of each right. Motors: 3 of 4 and 1 of 4 frames right.
// All, fold 1: slip 1/1, hold (1 + 3)/5 = 0.8; 90 %. Fold 2: slip 1/2, hold (1 + 1)/6; 41.7 %.
TEST(Figures, AreMeansOfFolds) {
  const auto frames = [](std::size_t slip_right, std::size_t slip_wrong, std::size_t hold_wrong, std::size_t hold_right) {
    return Confusion{{{}, {0, hold_right, 0, hold_wrong}, {}, {0, slip_wrong, 0, slip_right}}};
  };
  const std::vector<GroupCounts> folds{{frames(1, 0, 0, 1), frames(0, 0, 1, 3)}, {frames(1, 1, 1, 1), frames(0, 0, 3, 1)}};
  EXPECT_NEAR(on_slip(folds).accuracy.mean, 75.0, 1e-9);
  EXPECT_NEAR(on_slip(folds).accuracy.sd, 50.0 / std::sqrt(2.0), 1e-9);  // of two: their distance over the root of 2
  EXPECT_NEAR(on_slip(folds).f1.mean, 0.75, 1e-9);                       // 1, and 2/(2 + 1 + 1)
  const double second = 100.0 * 0.5 * (1.0 / 2.0 + 2.0 / 6.0);
  EXPECT_NEAR(on_all(folds).accuracy.mean, 0.5 * (90.0 + second), 1e-9);
  EXPECT_NEAR(motors_right(folds).mean, 50.0, 1e-9);
  EXPECT_EQ(cell(on_slip(folds)), "75.0 +- 35.4, 0.750");
  EXPECT_EQ(cell(on_slip({folds[0]})), "100.0, 1.000");
  EXPECT_EQ(cell(NetworkFigures{{std::nan(""), 0.0}, {}}), "-");
}

// 200 epochs of 3,200 recordings: a fifth judges, a fifth of the others validates, 2,048 are 64 steps of 32 clips.
TEST(StudySize, OfThePaperHas200Epochs) {
  const train::Validation full = StudySize{published_recordings, true}.training(gru_32(), 3);
  EXPECT_EQ(full.training.steps, 200U * 64U);
  EXPECT_EQ(full.training.validate_every, 64U);
  EXPECT_NEAR(full.validated, 0.2, 1e-12);
  EXPECT_EQ(full.training.seed, 3U);
  EXPECT_EQ(full.training.batch, 32U);
  EXPECT_EQ(full.training.optimiser, train::Optimiser::rmsprop);
  EXPECT_EQ(full.training.learning_rate, 8e-4);
  const train::Validation usual = StudySize{200, false}.training(mlp_32(), 1);
  EXPECT_EQ(usual.training.steps, train::find_recipe("piezo_mlp").training.steps);
  EXPECT_EQ(usual.validated, 0.0);
}

// Ten recordings with a slip and ten without, of 40 frames; a frame that slips is greater by 1 than one that holds, with noise of that size.
std::vector<PiezoRecording> many() {
  std::vector<PiezoRecording> all;
  RandomStream random(1, 0, "recordings");
  for (std::size_t k = 0; k < 20; ++k) {
    PiezoRecording one;
    one.motors_only = k % 2 == 0;
    one.inputs.emplace_back();
    for (std::size_t t = 0; t < 40; ++t) {
      const bool slips = !one.motors_only && t > 20;
      one.inputs[0].features.push_back(static_cast<float>(random.normal(slips ? 1.0 : 0.0, 1.0)));
      one.inputs[0].truth.push_back(slips ? 1 : 0);
    }
    one.inputs[0].paper = one.inputs[0].truth;
    all.push_back(one);
  }
  return all;
}

// Calls of a network hang on every bit of its weights where frames are near the threshold; here a third of them are.
TEST(Validations, DoNotDependOnJobs) {
  if (!train::networks_available()) GTEST_SKIP() << "no libtorch";
  const std::vector<PiezoRecording> recordings = many();
  NetworkRow row = row_of({train::Gru{8}});
  row.training = {.steps = 30, .batch = 8, .clip = 16, .learning_rate = 3e-3};
  const auto calls = [&](std::size_t jobs) {
    ReproduceOptions options;
    options.jobs = jobs;
    Validations validations(options, {recordings.size(), false});
    const std::size_t number = validations.queue_folds(recordings, row, LabelRule::paper);
    validations.run();
    EXPECT_EQ(validations.folds(number).size(), fold_count);
    return validations.calls(number);
  };
  const train::Calls alone = calls(1);
  ASSERT_EQ(alone.size(), recordings.size());
  for (const std::vector<std::uint8_t>& one : alone) EXPECT_EQ(one.size(), 40U);
  for (const std::size_t jobs : {2U, 5U}) EXPECT_EQ(calls(jobs), alone) << jobs;
}

TEST(NetworkTables, RefuseWhatMakesNoFolds) {
  if (!train::networks_available()) GTEST_SKIP() << "no libtorch";
  for (const char* name : {"table1", "table2", "table3", "table4", "delay"}) {
    ReproduceOptions options;
    options.trials = 9;
    const auto run = [&] { find_reproduction(std::string("piezo-fft-gru/") + name).run(options); };
    EXPECT_THAT(refusal_of(run), EndsWith("allowed: even numbers, 10 or more")) << name;
    options.data = "a.h5";
    EXPECT_THAT(refusal_of(run), HasSubstr("--trials is for recordings that are made")) << name;
  }
  ReproduceOptions options;
  options.only = {"gru_23"};
  for (const char* name : {"table1", "table4"}) {
    EXPECT_THAT(refusal_of([&] { find_reproduction(std::string("piezo-fft-gru/") + name).run(options); }), HasSubstr("gru_32"))
        << name;
  }
}

}  // namespace
}  // namespace slipbench::reproduce::piezo_networks_test
