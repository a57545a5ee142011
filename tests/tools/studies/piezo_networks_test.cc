// Examples and figures of the networks' tables, of plain values; frames of a made-up recording whose loudness and labels are known.
#include "tools/studies/piezo_fft_gru/piezo_networks.h"

#include <algorithm>
#include <cmath>

#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/program/train/recipes/recipe.h"
#include "tools/studies/study_catalogue.h"

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
    EXPECT_THAT(refusal_of(run), mentions({"even", "10"})) << name;
    options.data = "a.h5";
    EXPECT_THAT(refusal_of(run), mentions({"--trials"})) << name;
  }
  ReproduceOptions options;
  options.only = {"gru_23"};
  for (const char* name : {"table1", "table4"}) {
    EXPECT_THAT(refusal_of([&] { find_reproduction(std::string("piezo-fft-gru/") + name).run(options); }), HasSubstr("gru_32"))
        << name;
  }
}

using slipbench::testing::make_record;
using ::testing::FloatNear;

// 400 samples of a skin at 10 kHz, three frames. With a slip it is in contact, and slips from sample 250 on.
TrialRecord skin_record(std::size_t trial, bool slips, const std::string& params) {
  TrialRecord record = make_record(trial, 400);
  SensorRecord& sensor = record.sensors[0];
  sensor.type = "piezo_skin";
  sensor.rate = 10e3;
  sensor.channel_names = {"signal"};
  sensor.channels = {{"signal", "1", {1}, slipbench::testing::ramp(400, 5.0F)}};
  for (std::size_t i = 0; i < 400; ++i) sensor.time[i] = 1e-4 * static_cast<double>(i);
  for (auto* states : {&sensor.labels.state, &sensor.labels.state_micro, &sensor.labels.state_paper})
    states->assign(400, slips ? 1 : 0);
  if (slips) std::fill(sensor.labels.state_micro.begin() + 250, sensor.labels.state_micro.end(), std::uint8_t{3});
  if (slips) std::fill(sensor.labels.state_paper.begin() + 350, sensor.labels.state_paper.end(), std::uint8_t{3});
  std::ranges::fill(sensor.labels.micro_onset_time, slips ? 0.025 : std::nan(""));
  record.params = params;
  return record;
}

class PiezoRecordings : public slipbench::testing::FolderTest {};

TEST_F(PiezoRecordings, SayWhatWasSwept) {
  slipbench::testing::write_dataset(
      path("a.h5"), {"1", "slipbench: 1\n", "{}", 7, "slipbench sweep a.yaml"},
      {skin_record(0, true,
                   R"({"motion.vibration": 0.5, "friction.static": 0.9, "motion.speed": 0.01, "effects": ["asperities"]})"),
       skin_record(1, false, R"({"motion.vibration": 4.0})")});
  const std::vector<PiezoRecording> recordings = read_recordings(path("a.h5"), {published_spectra(), signal_at_100_hz()});
  ASSERT_THAT(recordings, SizeIs(2));
  EXPECT_EQ(recordings[0].level, 0.5);
  EXPECT_EQ(recordings[0].tip, R"(friction.static=0.9 effects=["asperities"])");
  EXPECT_FALSE(recordings[0].motors_only);
  ASSERT_THAT(recordings[0].inputs, SizeIs(2));
  const PiezoFrames &spectra = recordings[0].inputs[0], &signal = recordings[0].inputs[1];
  EXPECT_THAT(spectra.truth, ElementsAre(0, 1, 1));  // frames end with samples 199, 299, 399
  EXPECT_THAT(spectra.paper, ElementsAre(0, 0, 1));
  EXPECT_THAT(spectra.features, SizeIs(3 * 12));
  EXPECT_THAT(spectra.by(train::LabelRule::paper).label, ElementsAre(0, 0, 1));
  EXPECT_THAT(signal.truth, ElementsAre(0, 0, 0, 1));  // samples 0, 100, 200, 300
  EXPECT_THAT(signal.features, SizeIs(4));
  EXPECT_THAT(recordings[0].time, ElementsAre(DoubleNear(0.0199, 1e-9), DoubleNear(0.0299, 1e-9), DoubleNear(0.0399, 1e-9)));
  EXPECT_THAT(recordings[0].contact, ElementsAre(1, 1, 1));
  EXPECT_NEAR(recordings[0].slip_time, 0.025, 1e-9);
  EXPECT_NEAR(recordings[0].label_time, 0.035, 1e-9);
  EXPECT_EQ(recordings[1].level, 4.0);
  EXPECT_EQ(recordings[1].tip, "");
  EXPECT_TRUE(recordings[1].motors_only);
  EXPECT_THAT(recordings[1].inputs[0].truth, ElementsAre(0, 0, 0));
  EXPECT_THAT(recordings[1].contact, ElementsAre(0, 0, 0));
  EXPECT_TRUE(std::isnan(recordings[1].slip_time) && std::isnan(recordings[1].label_time));
}

// The bench moves by 3 mm/s along the surface and 1 mm/s along the normal; from 0.03 s on a motor of 20 mm/s that moves nothing runs, too.
TEST_F(PiezoRecordings, SayWhichMotorsRun) {
  TrialRecord record = skin_record(0, true, R"({"motion.idle_speed": 0.02, "motion.idle_start": 0.03})");
  record.bodies = {{"pad", std::vector<float>(400 * 7), std::vector<float>(400 * 6)}};
  record.body_time = record.sensors[0].time;
  for (std::size_t i = 0; i < 400; ++i) {
    record.bodies[0].velocity[6 * i] = -3e-3F;
    record.bodies[0].velocity[6 * i + 2] = 1e-3F;
  }
  EXPECT_THAT(make_recording(record, {published_spectra()}).motors,
              ElementsAre(FloatNear(4e-3F, 1e-8F), FloatNear(4e-3F, 1e-8F), FloatNear(24e-3F, 1e-8F)));
}

// At 0.89 s the tip stands still: it is pressed on by then (0.6 mm at 0.7 mm/s), and slides from 0.9 s on or later. What runs is another motor.
TEST_F(PiezoRecordings, OtherMotorsRunOnlyWhereTheyAreAskedFor) {
  ReproduceOptions options;
  options.seed = 1;
  const auto running = [&](Motors motors) {
    std::size_t count = 0;
    for (const PiezoRecording& one : run_recordings({2.0}, 30, {signal_at_100_hz()}, options, motors)) {
      if (one.motors_only) continue;
      const auto frame = std::ranges::lower_bound(one.time, 0.89) - one.time.begin() - 1;
      if (one.motors.at(static_cast<std::size_t>(frame)) > 0.0F) ++count;
    }
    return count;
  };
  EXPECT_EQ(running(Motors::of_the_tip), 0U);
  EXPECT_GT(running(Motors::others_too), 0U);
}

TEST_F(PiezoRecordings, HoldTheFramesOfEachInput) {
  const std::vector<network::Input> inputs{published_spectra(), spectra_of(0.0, 5000.0)};
  const PiezoRecording first = make_recording(skin_record(0, true, R"({"effects": 3})"), inputs);
  EXPECT_TRUE(std::isnan(first.level));
  EXPECT_EQ(first.tip, "effects=3");
  ASSERT_THAT(first.inputs, SizeIs(2));
  EXPECT_THAT(first.inputs[1].features, SizeIs(3 * 101));  // 0 to 5 kHz by 50 Hz
  EXPECT_FALSE(first.motors_only);
  EXPECT_TRUE(make_recording(skin_record(1, false, "{}"), inputs).motors_only);
}

TEST_F(PiezoRecordings, OfOtherSensorsAreRefused) {
  EXPECT_THAT(refusal_of([] { make_recording(make_record(2, 400), {published_spectra()}); }),
              mentions({"trial 2", "piezo_skin"}));
}

const double nan = std::nan("");
const std::vector<double> time{0.01, 0.02, 0.03, 0.04, 0.05, 0.06};  // s
using Calls = std::vector<std::uint8_t>;

TEST(AlarmDelay, IsOfTheAlarmThatIsOnOrTheNext) {
  EXPECT_NEAR(alarm_delay(time, Calls{1, 0, 0, 0, 1, 1}, 0.025), 0.025, 1e-12) << "the one of 0.01 is over";
  EXPECT_NEAR(alarm_delay(time, Calls{0, 1, 1, 1, 0, 1}, 0.042), -0.022, 1e-12) << "on since 0.02";
  EXPECT_NEAR(alarm_delay(time, Calls{1, 1, 1, 1, 0, 1}, 0.042), -0.032, 1e-12) << "on since the first frame";
  EXPECT_NEAR(alarm_delay(time, Calls{0, 0, 0, 1, 0, 0}, 0.04), 0.0, 1e-12);
  EXPECT_NEAR(alarm_delay(time, Calls{0, 1, 0, 0, 0, 0}, 0.001), 0.019, 1e-12) << "no frame is complete yet";
  EXPECT_TRUE(std::isnan(alarm_delay(time, Calls{1, 1, 0, 0, 0, 0}, 0.03)));
  EXPECT_TRUE(std::isnan(alarm_delay(time, Calls{0, 0, 0, 0, 0, 0}, 0.03)));
}

TEST(Alarms, AreCountedByBothRules) {
  Alarms alarms;
  alarms.add(time, Calls{1, 0, 0, 0, 1, 1}, 0.025);  // early by its first alarm, 25 ms by the next
  alarms.add(time, Calls{0, 0, 0, 1, 1, 1}, 0.025);  // 15 ms by both
  alarms.add(time, Calls{0, 0, 0, 0, 0, 0}, 0.025);  // missed, silent
  alarms.add(time, Calls{0, 0, 1, 0, 0, 0}, nan);    // a false alarm
  EXPECT_EQ(alarms.first.early, 1U);
  EXPECT_EQ(alarms.first.missed, 1U);
  EXPECT_EQ(alarms.first.false_alarms, 1U);
  EXPECT_EQ(alarms.first.slipping, 3U);
  EXPECT_EQ(alarms.silent, 1U);
  EXPECT_THAT(alarms.first.delay, ElementsAre(DoubleNear(0.015, 1e-12)));
  EXPECT_THAT(alarms.near, ElementsAre(DoubleNear(0.025, 1e-12), DoubleNear(0.015, 1e-12)));
}

// Of 0 to 10 ms the 10 % quantile is 1 ms and the 90 % one 9 ms; the variance of n = 11 whole numbers is n (n + 1)/12 = 11.
TEST(DelaySpread, IsInClosedForm) {
  std::vector<double> times;
  for (int k = 10; k >= 0; --k) times.push_back(1e-3 * k);
  const DelaySpread spread = delay_spread(times);
  EXPECT_NEAR(spread.mean, 5e-3, 1e-12);
  EXPECT_NEAR(spread.sd, 1e-3 * std::sqrt(11.0), 1e-12);
  EXPECT_NEAR(spread.median, 5e-3, 1e-12);
  EXPECT_NEAR(spread.p10, 1e-3, 1e-12);
  EXPECT_NEAR(spread.p90, 9e-3, 1e-12);
  EXPECT_NEAR(spread.greatest, 10e-3, 1e-12);
  EXPECT_EQ(cell(spread), "5 (1 to 9)");
  EXPECT_EQ(cell(delay_spread({})), "-");
}

}  // namespace
}  // namespace slipbench::reproduce::piezo_networks_test
