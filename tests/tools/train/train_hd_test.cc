#include "tools/train/train_hd.h"

#include <filesystem>
#include <set>

#include "detectors/hd/engine.h"
#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/tools/train/small_dataset.h"
#include "tools/dataset/reader.h"

namespace slipbench::testing::train_test {
namespace {

constexpr PadState non_slip = PadState::non_slip;
constexpr PadState incipient = PadState::incipient;
constexpr PadState gross = PadState::gross;

hd::Model small_model(hd::Encoding encoding = hd::Encoding::graph_spatial_temporal, bool context = true) {
  hd::Model model;
  model.dimension = 200;
  model.window = 4;
  model.encoding = encoding;
  model.context_driven = context;
  return model;
}

// All pillars lean by `lean` times their 1 mm of compression.
Displacements leaning(float lean) {
  Displacements frame{};
  for (std::size_t p = 0; p < 9; ++p) frame[3 * p] = 1e-3F * lean, frame[3 * p + 2] = 1e-3F;
  return frame;
}

// `rows` random frames in which all touch.
Sequence random_sequence(std::size_t trial, std::size_t rows) {
  RandomStream random(1, trial, "test");
  Sequence sequence;
  sequence.trial = trial;
  sequence.motion = {0.004, 0.0, 1e-3};
  for (std::size_t row = 0; row < rows; ++row) {
    sequence.time.push_back(0.01 * static_cast<double>(row));
    Displacements& frame = sequence.displacements.emplace_back();
    for (float& value : frame) value = static_cast<float>(random.uniform(-1.5e-3, 1.5e-3));
    sequence.label.push_back(static_cast<PadState>(1 + random.integer(3)));
    sequence.moving.push_back(1);
  }
  return sequence;
}

TEST(Encode, TakesFramesThatTouchAndHaveAWindowBehindThem) {
  Sequence sequence = random_sequence(0, 10);
  sequence.label[5] = sequence.label[9] = PadState::no_contact;
  for (const hd::Encoding encoding : {hd::Encoding::spatial, hd::Encoding::graph_spatial_temporal}) {
    const hd::Model model = small_model(encoding);
    std::vector<std::size_t> rows;
    for (const Sample& sample : encode(model, hd::generate(model, 1), hd::Quantiser::fixed_point, {&sequence, 1}, 1)) {
      rows.push_back(sample.row);
      EXPECT_EQ(sample.label, sequence.label[sample.row]);
    }
    EXPECT_EQ(rows, (std::vector<std::size_t>{3, 4, 6, 7, 8})) << static_cast<int>(encoding);
  }
}

TEST(Encode, ForgetsTheSequenceBefore) {
  const std::vector<Sequence> both{random_sequence(0, 12), random_sequence(1, 12)};
  const hd::Model model = small_model();
  const hd::Memories memories = hd::generate(model, 1);
  const std::vector<Sample> together = encode(model, memories, hd::Quantiser::fixed_point, both, 1);
  const std::vector<Sample> alone = encode(model, memories, hd::Quantiser::fixed_point, std::span(both).subspan(1), 1);
  ASSERT_EQ(together.size(), 2 * alone.size());
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(together[alone.size() + i].query, alone[i].query);
}

TEST(Encode, NamesTheTrialThatDoesNotFit) {
  Sequence sequence = random_sequence(7, 5);
  sequence.displacements[2][4] = 5.0F;  // m
  const hd::Model model = small_model();
  EXPECT_THAT(refusal_of([&] {
                encode(model, hd::generate(model, 1), hd::Quantiser::fixed_point, {&sequence, 1}, 2);
              }),
              mentions({"trial 7", "0.02 s"}));
}

// Three classes whose vectors differ in 120 bits of 200, with five more flipped in each sample.
// With a single pass the prototypes differ in those 120. Sums that begin at 0 add up to 0: no bit
// can have one sign in all three, so 400 bits differ over the pairs, except ties.
TEST(Fit, EpochsKeepPrototypesApart) {
  hd::Model model = small_model(hd::Encoding::spatial, false);
  const hd::Memories memories = hd::generate(model, 1);
  const auto turned = [&](hd::Hypervector vector, std::size_t from, std::size_t below, std::size_t bits, std::uint64_t stream) {
    const std::vector<std::size_t> order = shuffled(below - from, RandomStream(3, stream, "test"));
    for (std::size_t k = 0; k < bits; ++k) vector.set(from + order[k], !vector.bit(from + order[k]));
    return vector;
  };
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < 180; ++i) {
    const std::size_t kind = i % 3;
    const hd::Hypervector own = turned(memories.item[0], 60 * kind, 60 * kind + 60, 60, 0);
    samples.push_back({0, i, static_cast<PadState>(1 + kind), 1, 0, turned(own, 180, 200, 5, i)});
  }
  const std::vector<std::uint32_t> once(samples.size(), 1);
  const auto apart = [&](std::size_t epochs, std::uint64_t seed) {
    hd::Memories trained = memories;
    trained.associative = fit(model, memories, samples, once, epochs, seed);
    const Classifier classifier(model, trained);
    const auto right = [&](const Sample& sample) { return classifier.classify(sample) == sample.label; };
    EXPECT_TRUE(std::ranges::all_of(samples, right)) << epochs;
    const auto& a = trained.associative;
    return std::array{hd::hamming(a[0], a[1]), hd::hamming(a[0], a[2]), hd::hamming(a[1], a[2])};
  };
  EXPECT_EQ(apart(0, 1), (std::array<std::size_t, 3>{120, 120, 120}));
  const auto few = apart(5, 1);
  EXPECT_GT(few[0] + few[1] + few[2], 360U);
  EXPECT_NE(apart(5, 2), few);  // another order
}

// The engine's result in the loop, with either code path.
TEST(Classifier, SaysWhatTheEngineSays) {
  const std::vector<Sequence> sequences{random_sequence(0, 300)};
  for (const bool context : {true, false}) {
    const hd::Model model = small_model(hd::Encoding::graph_spatial_temporal, context);
    hd::Memories memories = hd::generate(model, 1);
    const std::vector<Sample> samples = encode(model, memories, hd::Quantiser::fixed_point, sequences, 1);
    memories.associative = fit(model, memories, samples, std::vector<std::uint32_t>(samples.size(), 1), 0, 1);
    const Classifier classifier(model, memories);
    const auto engine = hd::make_reference(model, memories);
    std::size_t next = 0;
    for (std::size_t row = 0; row < sequences[0].time.size(); ++row) {
      const hd::Decision decision = engine->update(hd::quantise(sequences[0].displacements[row], hd::Quantiser::fixed_point));
      if (decision.state == PadState::no_contact) continue;
      EXPECT_EQ(classifier.classify(samples[next++]), decision.state) << row;
    }
    EXPECT_EQ(next, samples.size());
  }
}

// Two identical prototypes are equally near to everything.
TEST(Classifier, GivesTiesToTheHigherClass) {
  const hd::Model model = small_model();
  hd::Memories memories = hd::generate(model, 1);
  const std::vector<Sequence> sequences{random_sequence(0, 5)};
  const std::vector<Sample> samples = encode(model, memories, hd::Quantiser::fixed_point, sequences, 1);
  memories.associative.assign(3, memories.item[0]);
  EXPECT_EQ(Classifier(model, memories).classify(samples[0]), gross);
}

// The lean alone determines the class, so that every query of a class equals its prototype and
// every test frame is right.
TEST(CrossValidation, IsPerfectWhereTheClassIsInTheFrame) {
  std::vector<Sequence> sequences;
  for (std::size_t trial = 0; trial < 12; ++trial) {
    Sequence sequence = random_sequence(trial, 30);
    for (std::size_t row = 0; row < 30; ++row) {
      sequence.label[row] = row < 10 ? non_slip : row < 20 ? incipient : gross;
      sequence.displacements[row] = leaning(row < 10 ? 0.0F : row < 20 ? 0.5F : 2.0F);
    }
    sequence.onset = 0.1;
    sequences.push_back(sequence);
  }
  const hd::Model model = small_model(hd::Encoding::spatial, false);
  const hd::Memories memories = hd::generate(model, 1);
  const std::vector<Sample> samples = encode(model, memories, hd::Quantiser::fixed_point, sequences, 1);
  for (const Evaluation& draw : cross_validate(model, memories, sequences, samples, Split::by_sequence, 0, 1, 1)) {
    EXPECT_EQ(accuracy(draw.all), 1.0);
    EXPECT_EQ(draw.delays.delay, std::vector<double>(draw.tested, 0.0));
    EXPECT_EQ(draw.delays.false_alarms, 0U);
  }
}

// Sequence k gives 2^k samples, so the number of tested samples shows which sequences were tested.
TEST(CrossValidation, TestsTheSequencesThatDidNotTrainAndNoOther) {
  std::vector<Sequence> sequences;
  std::vector<std::size_t> conditions;
  const hd::Model model = small_model();
  for (std::size_t k = 0; k < 8; ++k) {
    sequences.push_back(random_sequence(k, (std::size_t{1} << k) + model.window - 1));
    conditions.push_back(condition_of(sequences[k].motion));
  }
  const hd::Memories memories = hd::generate(model, 1);
  const std::vector<Sample> samples = encode(model, memories, hd::Quantiser::fixed_point, sequences, 1);
  const std::vector<Evaluation> draws = cross_validate(model, memories, sequences, samples, Split::by_sequence, 0, 9, 1);
  ASSERT_EQ(draws.size(), draw_count);
  for (std::size_t draw = 0; draw < draw_count; ++draw) {
    const BootstrapDraw drawn = bootstrap(conditions, 9, draw);
    std::uint64_t expected = 0;
    for (std::size_t k = 0; k < 8; ++k) expected += drawn.tests(k) ? std::uint64_t{1} << k : 0;
    EXPECT_EQ(samples_in_contact(draws[draw].all), expected) << draw;
    EXPECT_EQ(draws[draw].training, 8U);
    EXPECT_EQ(draws[draw].tested + draws[draw].distinct, 8U);
  }
}

TEST(CrossValidation, RefusesWhenNothingIsLeftToTest) {
  const std::vector<Sequence> one{random_sequence(0, 20)};
  const hd::Model model = small_model();
  const hd::Memories memories = hd::generate(model, 1);
  const std::vector<Sample> samples = encode(model, memories, hd::Quantiser::fixed_point, one, 1);
  EXPECT_THAT(refusal_of([&] { cross_validate(model, memories, one, samples, Split::by_sequence, 0, 1, 2); }),
              mentions({"draw 0", "4 frames", "found 1"}));
}

struct TrainTest : SmallDatasetTest {
  HdTraining options(const std::string& data, const std::string& folder, std::size_t jobs) {
    HdTraining training;
    training.dataset = data;
    training.model = small_model();
    training.all = true;  // all 24 trials, ignoring their masks
    training.jobs = jobs;
    training.output = path(folder);
    return training;
  }
  std::vector<std::string> files_of(const std::string& folder) {
    std::vector<std::string> texts;
    for (const char* name : {"AM.hex", "CIM.hex", "CM.hex", "IM.hex", "model.txt"})
      texts.push_back(bytes_of(path(folder) + "/" + name));
    return texts;
  }
};

TEST_F(TrainTest, SameSeedSameMemoriesAndFiguresOnAnyNumberOfThreads) {
  const std::string data = dataset();
  const HdSummary first = train_hd(options(data, "one", 1));
  const HdSummary second = train_hd(options(data, "three", 3));
  EXPECT_EQ(files_of("one"), files_of("three"));
  EXPECT_EQ(draws_json(first.by_sequence), draws_json(second.by_sequence));
  EXPECT_EQ(draws_json(first.by_frame), draws_json(second.by_frame));
  HdTraining other = options(data, "other", 1);
  other.seed = 2;
  train_hd(other);
  EXPECT_NE(files_of("one")[3], files_of("other")[3]);
}

// 0.4 s at 1 kHz are 400 samples, every tenth a frame: 40, and the pad touches to the end.
TEST_F(TrainTest, SaysThatTheWindowIsLongerThanTheSequences) {
  HdTraining training = options(dataset(), "memories", 1);
  training.model.window = 1000;
  EXPECT_THAT(refusal_of([&] { train_hd(training); }), mentions({"data.h5", "1000 frames", "40"}));
  training.model.window = 41;
  EXPECT_THAT(refusal_of([&] { train_hd(training); }), mentions({"41 frames"}));
  // The last frame of each of the 24, 0.19 s after the slide began: all of them slip.
  training.model.window = 40;
  EXPECT_THAT(refusal_of([&] { train_hd(training); }), mentions({"0", "24 slip", "paper"}));
}

// A pad that is pressed and never moved does not slip: "non-slip" would always be right.
TEST_F(TrainTest, RefusesDataWithoutASlip) {
  HdTraining training = options(dataset({{"sweep.motion.speed", "[0 mm/s]"}}), "memories", 1);
  EXPECT_THAT(refusal_of([&] { train_hd(training); }), mentions({"0 slip", "paper"}));
  EXPECT_FALSE(std::filesystem::exists(path("memories")));
}

TEST_F(TrainTest, TeachesThePublishedCoresBundleAndEpochs) {
  const std::string data = dataset();
  train_hd(options(data, "paper", 1));
  HdTraining training = options(data, "core", 1);
  training.model.compat = hd::Compat::published_core;
  train_hd(training);
  EXPECT_EQ(hd::load(path("core")).model, training.model);
  training.epochs = 2;
  training.point = true;
  training.output = path("epochs");
  training.with = {data};
  EXPECT_THAT(refusal_of([&] { train_hd(training); }), mentions({"data.h5", "each trial once"}));
  training.with = {dataset({{"seed", "6"}}, "more.h5")};
  const HdSummary summary = train_hd(training);
  EXPECT_EQ(summary.sequences, 48U);
  EXPECT_EQ(hd::load(path("epochs")).alarm.off, summary.alarm.off);
  EXPECT_THAT(hd::load(path("epochs")).trained, EndsWith("seed 1, all 48 sequences, 2 epochs"));
  EXPECT_NE(files_of("epochs")[0], files_of("core")[0]);
  EXPECT_NE(files_of("core")[0], files_of("paper")[0]);
}

// Shares of 1/2, 1/4 and 1/4 of 24 trials: 12 are for training, and the others influence neither
// the draws nor the saved model.
TEST_F(TrainTest, LearnsFromThePartTrainAlone) {
  const std::string data = dataset({{"split", "{by: trial, shares: [0.5, 0.25, 0.25]}"}});
  HdTraining training = options(data, "part", 1);
  training.all = false;
  const HdSummary summary = train_hd(training);
  EXPECT_EQ(summary.trials, 24U);
  EXPECT_EQ(summary.sequences, 12U);
  EXPECT_TRUE(summary.own_split);
  EXPECT_EQ(summary.test, data);
  EXPECT_THAT(hd::load(path("part")).trained, EndsWith("12 of 24 sequences (part train)"));
  for (const Evaluation& draw : summary.by_sequence) EXPECT_EQ(draw.distinct + draw.tested, 12U);
  const DatasetReader reader(data);
  std::set<std::string> digests;
  for (const std::size_t trial : reader.mask("train")) digests.insert(reader.trial_sha256(trial));
  EXPECT_EQ(digests.size(), 12U);
  EXPECT_EQ(hd::seen_by(path("part")), digests);

  train_hd(options(data, "all", 1));
  EXPECT_EQ(hd::seen_by(path("all"))->size(), 24U);
  EXPECT_NE(files_of("all")[0], files_of("part")[0]);
}

// The memory shipped for any surface. Its prototypes differ clearly, and flipping one bit in a
// hundred, as in a worn memory, changes few answers on trials not used for training.
TEST_F(TrainTest, TheShippedMemoryIsNoRuleOfAFewBits) {
  hd::SavedModel saved = hd::load(SLIPBENCH_SOURCE_DIR "/detectors/hd/memories/learn_gst_hd");
  std::vector<hd::Hypervector>& prototypes = saved.memories.associative;
  for (const auto& [a, b] : {std::pair{0, 1}, {0, 2}, {1, 2}}) EXPECT_GE(hd::hamming(prototypes[a], prototypes[b]), 400U);

  SweepOptions sweep;
  sweep.scene_path = SLIPBENCH_SOURCE_DIR "/scenes/learn/papillarray.yaml";
  sweep.overrides = {{"seed", "77"}};
  sweep.trials = 2;
  sweep.output = path("held.h5");
  run_sweep(sweep, program_catalogues());
  const std::vector<Sequence> sequences = read_sequences(sweep.output, {LabelRule::micro, ""}).sequences;
  const std::vector<Sample> samples = encode(saved.model, saved.memories, saved.quantiser, sequences, 1);
  const auto answers = [&] {
    const Classifier classifier(saved.model, saved.memories);
    std::vector<bool> slipping;
    for (const Sample& sample : samples) slipping.push_back(slips(classifier.classify(sample)));
    return slipping;
  };
  const std::vector<bool> whole = answers();
  for (std::size_t k = 0; k < prototypes.size(); ++k) {
    const std::vector<std::size_t> order = shuffled(saved.model.dimension, RandomStream(1, k, "worn"));
    for (std::size_t i = 0; i < 10; ++i) prototypes[k].set(order[i], !prototypes[k].bit(order[i]));
  }
  const std::vector<bool> worn = answers();
  std::size_t changed = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) changed += whole[i] != worn[i] ? 1U : 0U;
  const auto slipping = static_cast<std::size_t>(std::ranges::count(whole, true));
  EXPECT_GT(slipping, whole.size() / 50);
  EXPECT_LT(slipping, whole.size() / 4);
  EXPECT_LT(changed, whole.size() / 25);
}

// The dataset does not exist: the error shows what is checked first.
TEST_F(TrainTest, RefusesItsTargetBeforeItReads) {
  std::ofstream(path("own.html")) << "years of work";
  EXPECT_THAT(refusal_of([&] { train_hd(options(path("nowhere.h5"), "own.html", 1)); }), mentions({"own.html", "folder"}));
  EXPECT_THAT(refusal_of([&] { train_hd(options(path("nowhere.h5"), "own.html/model", 1)); }),
              mentions({"own.html/model", "Not a directory"}));
  EXPECT_THAT(refusal_of([&] { train_hd(options(path("nowhere.h5"), "new", 1)); }), HasSubstr("nowhere.h5"));
  EXPECT_EQ(bytes_of(path("own.html")), "years of work");
}

}  // namespace
}  // namespace slipbench::testing::train_test
