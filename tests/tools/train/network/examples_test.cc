#include "tools/train/network/examples.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/train/network/split.h"

namespace slipbench::train::examples_test {
namespace {

constexpr double rate = 10e3;

// Frames of 20 ms at 100 Hz.
network::Input signal_frames() {
  network::Input input;
  input.sensor = "piezo_skin";
  input.rate = rate;
  input.channels = {{"signal", {}}};
  input.stride = 100;
  return input;
}

// Spectra from 50 to 600 Hz: 12 bins. The floor is that of rounding to whole counts.
network::Input spectra() {
  network::Input input = signal_frames();
  input.window = 200;
  input.centre = true;
  input.transform = network::Transform::log_psd;
  input.low = 50.0;
  input.high = 600.0;
  input.floor = 1.0 / 12.0 / (0.5 * rate);
  return input;
}

// 450 samples of a sticking piezo_skin: frames of 200 end with the samples 199, 299 and 399.
SensorRecord skin(std::size_t samples = 450) {
  SensorRecord sensor;
  sensor.name = "skin";
  sensor.type = "piezo_skin";
  sensor.rate = rate;
  sensor.channels.push_back({"signal", "counts", {1}, std::vector<float>(samples, 7.0F)});
  for (std::size_t i = 0; i < samples; ++i) sensor.time.push_back(static_cast<double>(i) / rate);
  for (auto* states : {&sensor.labels.state, &sensor.labels.state_micro, &sensor.labels.state_paper}) states->assign(samples, 1);
  return sensor;
}

void set(std::vector<std::uint8_t>& states, std::size_t first, std::size_t last, PadState state) {
  std::fill(states.begin() + static_cast<std::ptrdiff_t>(first), states.begin() + static_cast<std::ptrdiff_t>(last),
            static_cast<std::uint8_t>(state));
}

Example example(const SensorRecord& sensor, LabelRule labels, const TrialRecord& record = {}) {
  ExampleOptions options;
  options.input = spectra();
  options.labels = labels;
  return example_of(record, sensor, options);
}

// A sine of 300 Hz has six whole periods in a frame: its variance a^2/2 is all in the bin of 300
// Hz, 50 Hz wide. Silence has the level of rounding, 1/12 counts^2 over 5 kHz.
TEST(PiezoFrames, OfASineAreOneBin) {
  SensorRecord sensor = skin();
  constexpr double amplitude = 40.0, rounding = 1.0 / 12.0 / 5000.0;
  for (std::size_t i = 0; i < 450; ++i) {
    sensor.channels[0].values[i] =
        static_cast<float>(1000.0 + amplitude * std::sin(2.0 * std::numbers::pi * 300.0 * static_cast<double>(i) / rate));
  }
  const std::vector<float> features = example(sensor, LabelRule::micro).frames.features;
  ASSERT_EQ(features.size(), 3U * 12U);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const double expected = i % 12 == 5 ? std::log10(amplitude * amplitude / 2.0 / 50.0 + rounding) : std::log10(rounding);
    EXPECT_NEAR(features[i], expected, 1e-3) << i;  // float32 samples of 1000 counts are rounded by 3e-5
  }
}

// Each rule has another beginning of slip; a frame has the label of its last sample.
TEST(Example, LabelsAFrameByItsEnd) {
  SensorRecord sensor = skin();
  set(sensor.labels.state_micro, 250, 450, PadState::incipient);
  set(sensor.labels.state_paper, 300, 450, PadState::gross);
  sensor.labels.micro_onset_time = {std::nan(""), 0.025};
  sensor.labels.onset_time = {std::nan(""), std::nan("")};
  const Example micro = example(sensor, LabelRule::micro);
  EXPECT_THAT(micro.frames.label, ElementsAre(0, 1, 1));
  EXPECT_THAT(micro.time, ElementsAre(sensor.time[199], sensor.time[299], sensor.time[399]));
  EXPECT_EQ(micro.onset, 0.025);
  EXPECT_TRUE(micro.touches);
  EXPECT_THAT(example(sensor, LabelRule::paper).frames.label, ElementsAre(0, 0, 1));
  EXPECT_THAT(example(sensor, LabelRule::strict).frames.label, ElementsAre(0, 0, 0));
  EXPECT_TRUE(std::isnan(example(sensor, LabelRule::strict).onset));
}

// Slip from 150 to 250, then rest, contact lost from 380 on, touched again from 390 on: the frames
// end in slip, in rest, and in a new contact.
// The network reads 100 Hz. At a rate drawn from 20 Hz to 10 kHz a straight line remains one, with a
// frame each 10 ms; a frame comes with a later sample, at most one and a half steps of the drawn rate
// and of the sensor later. Over 40 trials more than half of the drawn logarithm lies below 500 Hz, and
// some draws below 100 Hz, whose frames come up to 50 ms late.
TEST(Example, HasADrawnRate) {
  SensorRecord sensor = skin(5000);
  for (std::size_t i = 0; i < 5000; ++i) sensor.channels[0].values[i] = static_cast<float>(i);
  ExampleOptions options;
  options.input = signal_frames();
  options.labels = LabelRule::strict;
  options.input.slowest = 20.0;
  options.input.fastest = 20e3;
  std::set<double> latest;
  for (std::size_t trial = 0; trial < 40; ++trial) {
    TrialRecord record;
    record.trial = trial;
    const Example one = example_of(record, sensor, options);
    EXPECT_EQ(one.time, example_of(record, sensor, options).time) << "the same draw";
    ASSERT_GE(one.time.size(), 44U);
    EXPECT_EQ(one.frames.label.size(), one.time.size());
    double late = 0.0;
    for (std::size_t k = 0; k < one.time.size(); ++k) {
      const double due = 0.01 * static_cast<double>(k);
      // By the drawn clock, which is within 1 % of a multiple of 100 Hz or exact.
      EXPECT_NEAR(one.frames.features[k], 1e4 * due, 1e4 * (0.01 * due + 1e-4)) << trial << ", frame " << k;
      EXPECT_GE(one.time[k], due * 0.99 - 1e-9);
      late = std::max(late, one.time[k] - due);
    }
    EXPECT_LE(late, 0.05 + 1.5 / rate + 1e-9);
    latest.insert(late);
  }
  EXPECT_GT(*latest.rbegin(), 0.011);
  EXPECT_LT(*latest.begin(), 0.002);
  options.input.slowest = 15e3;
  EXPECT_THAT(refusal_of([&] { example_of({}, sensor, options); }), mentions({"sensor skin", "10000 Hz", "15000 Hz"}));
}

TEST(Example, LatchesOrMasksRestAfterASlip) {
  SensorRecord sensor = skin();
  set(sensor.labels.state_micro, 150, 250, PadState::incipient);
  set(sensor.labels.state_micro, 380, 390, PadState::no_contact);
  EXPECT_THAT(example(sensor, LabelRule::micro).frames.label, ElementsAre(1, 0, 0));
  EXPECT_THAT(example(sensor, LabelRule::latched).frames.label, ElementsAre(1, 1, 0));
  EXPECT_THAT(example(sensor, LabelRule::masked).frames.label, ElementsAre(1, masked, 0));
  EXPECT_THAT(example(sensor, LabelRule::tightened).frames.label, ElementsAre(1, masked, 0));
  TrialRecord grasp;
  grasp.outcome.grasp.emplace();
  EXPECT_THAT(example(sensor, LabelRule::masked, grasp).frames.label, ElementsAre(1, masked, 0));
  EXPECT_THAT(example(sensor, LabelRule::tightened, grasp).frames.label, ElementsAre(1, 0, 0));
}

// A slip of one unit from sample 150 to 350 by `step` m a sample; the frames end after 50 and 150
// samples of slip, and after its end.
SensorRecord slipping_skin(double step) {
  SensorRecord sensor = skin();
  set(sensor.labels.state_micro, 150, 350, PadState::gross);
  sensor.labels.k_normal = {1.0};
  sensor.labels.unit_state.assign(450, static_cast<std::uint8_t>(UnitState::stick));
  for (int row = 0; row < 450; ++row)
    sensor.labels.slip_distance.push_back(static_cast<float>(step * std::clamp(row - 149, 0, 200)));
  return sensor;
}

// 0.5 um a sample: 25 um in the first frame, 75 um in the second.
TEST(Example, CountsASlipOnceTheObjectHasMoved) {
  TrialRecord grasp;
  grasp.outcome.grasp.emplace();
  EXPECT_THAT(example(slipping_skin(0.5e-6), LabelRule::tightened).frames.label, ElementsAre(1, 1, masked));
  EXPECT_THAT(example(slipping_skin(0.5e-6), LabelRule::moved).frames.label, ElementsAre(masked, 1, masked));
  EXPECT_THAT(example(slipping_skin(0.5e-6), LabelRule::moved, grasp).frames.label, ElementsAre(masked, 1, 0));
  EXPECT_THAT(example(slipping_skin(0.2e-6), LabelRule::moved).frames.label, ElementsAre(0, 0, 0)) << "40 um";
}

// Two slips of 31.5 um, 90 samples each; the path grows by 7 um between them.
TEST(Example, JoinsTheSlipsOfAContactOnAStage) {
  SensorRecord sensor = slipping_skin(0.35e-6);
  set(sensor.labels.state_micro, 240, 260, PadState::non_slip);
  TrialRecord grasp;
  grasp.outcome.grasp.emplace();
  const Example joined = example(sensor, LabelRule::moved);
  EXPECT_THAT(joined.frames.label, ElementsAre(masked, 1, masked));
  EXPECT_THAT(joined.scored, ElementsAre(1, 1, masked));
  EXPECT_THAT(example(sensor, LabelRule::moved, grasp).frames.label, ElementsAre(0, 0, 0));

  // In two contacts each slip is below 0.05 mm.
  set(sensor.labels.state_micro, 240, 260, PadState::no_contact);
  EXPECT_THAT(example(sensor, LabelRule::moved).frames.label, ElementsAre(0, 0, 0));
  // Slips of 54 um: the second begins anew, so its frame after 24 um is masked.
  SensorRecord large = slipping_skin(0.6e-6);
  set(large.labels.state_micro, 240, 260, PadState::no_contact);
  EXPECT_THAT(example(large, LabelRule::moved).frames.label, ElementsAre(masked, masked, masked));
}

// The object moves between two samples, and sticks in both.
TEST(Example, CountsASlipBetweenTwoSamples) {
  const auto jump = [](float size) {
    SensorRecord sensor = slipping_skin(0.0);
    sensor.labels.state_micro.assign(450, static_cast<std::uint8_t>(PadState::non_slip));
    std::fill(sensor.labels.slip_distance.begin() + 299, sensor.labels.slip_distance.end(), size);
    sensor.labels.micro_onset_time = {0.02985};
    return sensor;
  };
  const Example large = example(jump(60e-6F), LabelRule::moved);
  EXPECT_THAT(large.frames.label, ElementsAre(0, 1, masked));
  EXPECT_THAT(large.scored, ElementsAre(0, 1, masked));
  EXPECT_FALSE(large.holds);
  EXPECT_THAT(example(jump(40e-6F), LabelRule::moved).frames.label, ElementsAre(0, 0, 0));
}

TEST(Example, NeedsAPathForTheRuleMoved) {
  EXPECT_THAT(refusal_of([] { example(skin(), LabelRule::moved); }), mentions({"slip distance"}));
}

// Four units at the corners of a square of 2 mm: all translate, turn about the middle, or do both,
// with a rim speed below or above the translation.
TEST(Example, TellsTranslationFromRotation) {
  SensorRecord sensor = skin(200);
  sensor.labels.k_normal.assign(4, 1.0);
  sensor.labels.unit_positions = {1e-3, 0.0, 0.0, 1e-3, -1e-3, 0.0, 0.0, -1e-3};
  set(sensor.labels.state_micro, 0, 200, PadState::gross);
  const auto label = [&](double x, double y, double turn) {
    sensor.labels.slip_velocity.assign(200 * 8, 0.0F);
    for (std::size_t u = 0; u < 4; ++u) {
      const std::size_t at = 199 * 8 + 2 * u;
      sensor.labels.slip_velocity[at] = static_cast<float>(x - turn * sensor.labels.unit_positions[2 * u + 1]);
      sensor.labels.slip_velocity[at + 1] = static_cast<float>(y + turn * sensor.labels.unit_positions[2 * u]);
    }
    ExampleOptions options;
    options.input = spectra();
    options.classes = ClassRule::kind;
    return example_of({}, sensor, options).frames.label.back();
  };
  EXPECT_EQ(label(1e-3, 0.0, 0.0), 1);
  EXPECT_EQ(label(0.0, 0.0, 1.0), 2);
  EXPECT_EQ(label(0.0, -1e-3, 0.9), 1);  // 0.9 mm/s at the rim
  EXPECT_EQ(label(0.0, -1e-3, 1.1), 2);
  EXPECT_EQ(label(0.0, 0.0, 0.0), masked);  // slipping by its label, but nothing moves
}

// By the commanded motion; without contact there is no direction. Samples 0 to 249 have no contact.
TEST(Example, HasTheDirectionOfItsMotion) {
  SensorRecord sensor = skin();
  set(sensor.labels.state_micro, 0, 250, PadState::no_contact);
  const auto label = [&](const std::string& speed, const std::string& rotation, const std::string& direction) {
    TrialRecord record;
    record.params =
        R"({"motion.speed": )" + speed + R"(, "motion.rotation": )" + rotation + R"(, "motion.direction": )" + direction + "}";
    ExampleOptions options;
    options.input = spectra();
    options.classes = ClassRule::direction;
    const std::vector<std::uint8_t> labels = example_of(record, sensor, options).frames.label;
    EXPECT_EQ(labels.front(), masked);
    return classes_of(ClassRule::direction, LabelRule::micro).at(labels.back()).name;
  };
  EXPECT_EQ(label("0.008", "0", "0"), "n");
  EXPECT_EQ(label("0.008", "0", "1.5707963"), "e");
  EXPECT_EQ(label("0.008", "0", "3.1415927"), "s");
  EXPECT_EQ(label("0.008", "0", "4.712389"), "w");
  EXPECT_EQ(label("0", "0.66", "0"), "cw");
  EXPECT_EQ(label("0", "-0.66", "0"), "aw");
  EXPECT_EQ(label("0", "0", "0"), "t");
  EXPECT_THROW(label("0", "0", "null"), InputError);
  TrialRecord imported;  // has its class, but no truth
  imported.params = R"({"object": "pen", "class": "cw"})";
  sensor.labels.state_micro.clear();
  sensor.labels.truth = false;
  ExampleOptions options;
  options.input = spectra();
  options.classes = ClassRule::direction;
  EXPECT_THAT(refusal_of([&] { example_of(imported, sensor, options); }), mentions({"--labels recorded"}));
  options.labels = LabelRule::recorded;
  EXPECT_THAT(example_of(imported, sensor, options).frames.label, ElementsAre(5, 5, 5));
  EXPECT_EQ(example_of(imported, sensor, options).object, R"(object="pen")");
}

// By `latched`: 600 samples, the first 100 without contact; then all stick, a whole unit slips,
// more than half slip, all stick again.
TEST(Example, SlipsInItsDirectionFromWhereMoreThanHalfDoes) {
  SensorRecord sensor = skin(600);
  set(sensor.labels.state_micro, 0, 600, PadState::non_slip);
  set(sensor.labels.state_micro, 0, 100, PadState::no_contact);
  sensor.labels.state = sensor.labels.state_micro;
  set(sensor.labels.state, 200, 400, PadState::incipient);
  sensor.labels.stuck_fraction.assign(600, 1.0F);
  std::fill(sensor.labels.stuck_fraction.begin() + 300, sensor.labels.stuck_fraction.begin() + 400, 0.4F);
  ExampleOptions options;
  options.input = signal_frames();
  options.input.window = 100;
  options.classes = ClassRule::direction;
  options.labels = LabelRule::latched;
  TrialRecord record;
  record.params = R"({"motion.speed": 0.008, "motion.rotation": 0, "motion.direction": 0})";
  EXPECT_THAT(example_of(record, sensor, options).frames.label, ElementsAre(masked, 0, masked, 1, 1, 1));
  record.params = R"({"motion.speed": 0, "motion.rotation": 0, "motion.direction": 0})";
  EXPECT_THAT(example_of(record, sensor, options).frames.label, ElementsAre(masked, 0, 0, masked, 0, 0));
}

TEST(Example, KeepsAtMostSoManyOfAClass) {
  SensorRecord sensor = skin(2200);                                 // 21 frames
  set(sensor.labels.state_micro, 1200, 2200, PadState::incipient);  // frames that end with 1299 to 2199: ten
  ExampleOptions options;
  options.input = spectra();
  options.at_most = 4;
  const Example kept = example_of({}, sensor, options);
  EXPECT_THAT(kept.frames.label, ElementsAre(0, 0, 0, 0, 1, 1, 1, 1));
  EXPECT_EQ(kept.frames.features.size(), 8U * 12U);
  EXPECT_TRUE(std::ranges::is_sorted(kept.time));
  EXPECT_EQ(example_of({}, sensor, options).time, kept.time);
  options.seed = 2;
  EXPECT_NE(example_of({}, sensor, options).time, kept.time);
}

TEST(Example, OtherSensorsAreRefused) {
  SensorRecord slow = skin();
  slow.rate = 1000.0;
  EXPECT_THROW(example(slow, LabelRule::micro), InputError);
  EXPECT_THROW(example(skin(199), LabelRule::micro), InputError);  // shorter than a frame
  SensorRecord unlabelled = skin();
  unlabelled.labels.state_micro.clear();
  unlabelled.labels.state_paper.clear();
  EXPECT_THAT(refusal_of([&] { example(unlabelled, LabelRule::micro); }), mentions({"0 states", "micro", "450 samples"}));
}

// A recording has only its set's own labels, and a rate that is slightly off.
TEST(Example, OfARecordingIsByItsOwnLabels) {
  SensorRecord recording = skin();
  recording.labels.state_micro.clear();
  recording.labels.truth = false;
  recording.rate = 1e6 / 100.4;
  for (const LabelRule rule : {LabelRule::latched, LabelRule::paper})
    EXPECT_THAT(refusal_of([&] { example(recording, rule); }), mentions({"is recorded", "--labels recorded"}));
  EXPECT_THAT(example(recording, LabelRule::recorded).frames.label, ElementsAre(0, 0, 0));
  EXPECT_THAT(refusal_of([&] { example(skin(), LabelRule::recorded); }), mentions({"is simulated", "strict, micro, paper"}));
}

// Frames end with the samples 199, 299 and 399.
TEST(Example, FramesOfUnknownLabelsAreMasked) {
  SensorRecord recording = skin();
  recording.labels.state_micro.clear();
  recording.labels.truth = false;
  set(recording.labels.state_paper, 250, 350, unknown_state);
  set(recording.labels.state_paper, 350, 450, PadState::gross);
  EXPECT_THAT(example(recording, LabelRule::recorded).frames.label, ElementsAre(0, masked, 1));
}

TEST(SweptFacts, AreOfTheTrialsParameters) {
  const SweptFacts facts = swept_facts(
      R"({"surface.material": "glass", "bodies.object.shape": "box", "bodies.object.mass": 0.25, "bodies.object.position": [0, 1, 2],
          "motion.speed": 0.004, "motion.travel": 0.1, "friction.scale": 1.1, "controls.squeeze": 0.01})");
  EXPECT_EQ(facts.material, R"(surface.material="glass")");
  EXPECT_EQ(facts.object, R"(surface.material="glass" bodies.object.shape="box")");
  EXPECT_EQ(facts.speed, 0.004);
  EXPECT_EQ(facts.mass, 0.25);
  EXPECT_EQ(swept_facts("{}").object, "");
  EXPECT_TRUE(std::isnan(swept_facts("{}").speed));
}

std::vector<Example> trials(std::size_t count) {
  std::vector<Example> all(count);
  for (std::size_t i = 0; i < count; ++i) {
    all[i].trial = i;
    all[i].touches = i % 2 == 0;
    all[i].material = i % 3 == 0 ? "a" : i % 3 == 1 ? "b" : "c";
    all[i].speed = 1e-3 * std::pow(2.0, static_cast<double>(i % 4));
  }
  return all;
}

// A fifth of 20 trials is for judging, and a fifth of the other 16 for validation, rounded up: 4
// and 4. Half of them touch.
TEST(SplitExamples, DealsTrialsOutWithAndWithoutContact) {
  const std::vector<Example> all = trials(20);
  const std::vector<Part> parts = split_examples(all, Split::trial, 0.2, 1);
  EXPECT_EQ(std::ranges::count(parts, Part::judges), 4);
  EXPECT_EQ(std::ranges::count(parts, Part::validates), 4);
  std::size_t touching = 0;
  for (std::size_t i = 0; i < 20; ++i) touching += parts[i] == Part::judges && all[i].touches ? 1 : 0;
  EXPECT_EQ(touching, 2U);
  EXPECT_EQ(split_examples(all, Split::trial, 0.2, 1), parts);
  EXPECT_NE(split_examples(all, Split::trial, 0.2, 2), parts);
  EXPECT_EQ(std::ranges::count(split_examples(all, Split::trial, 0.0, 1), Part::judges), 0);
}

// Ten experiments, each done twice: 2 are for judging and a fifth of the other 8 for validation,
// rounded up; both of a pair are in one part.
TEST(SplitExamples, KeepsTwinsTogether) {
  std::vector<Example> all = trials(20);
  for (std::size_t i = 0; i < 20; ++i) {
    all[i].twin = std::to_string(i % 10);
    all[i].touches = true;
  }
  const std::vector<Part> parts = split_examples(all, Split::trial, 0.2, 1);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(parts[i], parts[i + 10]);
  EXPECT_EQ(std::ranges::count(parts, Part::judges), 4);
  EXPECT_EQ(std::ranges::count(parts, Part::validates), 4);
}

// Eight classes of five trials each: a fifth of 40, 8, is for judging, and a fifth of 32, 7, for
// validation. Each part has its share of each class, without repetition.
TEST(SplitExamples, DealsEachClassOut) {
  std::vector<Example> all = trials(40);
  for (std::size_t i = 0; i < 40; ++i) {
    all[i].touches = true;
    all[i].frames.label.assign(3, static_cast<std::uint8_t>(i % 8));
  }
  const std::vector<Part> parts = split_examples(all, Split::trial, 0.2, 1);
  for (const Part part : {Part::judges, Part::validates}) {
    std::set<std::size_t> classes;
    for (std::size_t i = 0; i < 40; ++i) {
      if (parts[i] == part) classes.insert(i % 8);
    }
    EXPECT_EQ(classes.size(), part == Part::judges ? 8U : 7U);
    EXPECT_EQ(std::ranges::count(parts, part), static_cast<std::ptrdiff_t>(classes.size()));
  }
}

// Test groups are never trained on: one of three materials, one of four octaves of speed.
TEST(SplitExamples, HoldsAWholeGroupOut) {
  const std::vector<Example> all = trials(24);
  for (const Split split : {Split::material, Split::speed}) {
    const std::vector<Part> parts = split_examples(all, split, 0.2, 1);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = 0; k < all.size(); ++k) {
        const bool same = split == Split::material ? all[i].material == all[k].material : all[i].speed == all[k].speed;
        EXPECT_TRUE(!same || (parts[i] == Part::judges) == (parts[k] == Part::judges));
      }
    }
    EXPECT_EQ(std::ranges::count(parts, Part::judges), split == Split::material ? 8 : 6);
    EXPECT_GT(std::ranges::count(parts, Part::validates), 0);
  }
}

// Both sensors of a trial are on one side, and turned copies are for training only.
TEST(SplitExamples, KeepsATrialTogether) {
  std::vector<Example> all = trials(10);
  for (std::size_t i = 0; i < 10; ++i) {
    all.push_back(all[i]);
    all.back().turn = 3;
  }
  const std::vector<Part> parts = split_examples(all, Split::trial, 0.2, 1);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(parts[10 + i], parts[i] == Part::learns ? Part::learns : Part::left_out);
}

// 20 trials in parts of 10, 0 and 10: a fifth of the first ten, 2, is for validation. Ten more
// without a part are dealt out as usual: a fifth, 2, is for judging.
TEST(SplitExamples, KeepsToThePartsOfADataset) {
  std::vector<Example> all = trials(20);
  for (Example& example : all) example.part = example.trial % 2 == 0 ? "train" : "test";
  all[3].part = "none";
  std::vector<Part> parts = split_examples(all, Split::object, 0.0, 1);  // no objects are known, and nothing is divided by them
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(parts[i] == Part::judges, i % 2 == 1 && i != 3) << i;
  EXPECT_EQ(parts[3], Part::left_out);
  EXPECT_EQ(std::ranges::count(parts, Part::validates), 2);
  EXPECT_EQ(std::ranges::count(parts, Part::learns), 8);

  for (Example more : trials(10)) {
    more.trial += 20;
    all.push_back(more);
  }
  parts = split_examples(all, Split::trial, 0.2, 1);
  EXPECT_EQ(std::count(parts.begin() + 20, parts.end(), Part::judges), 2);
  all[0].part = all[2].part = "valid";
  parts = split_examples(all, Split::trial, 0.2, 1);
  EXPECT_EQ(std::count(parts.begin(), parts.begin() + 20, Part::validates), 2);
  EXPECT_EQ(parts[0], Part::validates);
}

TEST(SplitExamples, NeedsSomethingOnEachSide) {
  EXPECT_THROW(split_examples(trials(1), Split::trial, 0.2, 1), InputError);
  EXPECT_THROW(split_examples(trials(20), Split::object, 0.2, 1), InputError);  // no object is known
}

}  // namespace
}  // namespace slipbench::train::examples_test
