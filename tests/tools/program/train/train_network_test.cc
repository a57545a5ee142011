#include "tools/program/train/train_network.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "detectors/network/engine.h"
#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/tools/program/train/small_dataset.h"
#include "tools/base/dataset/reader.h"

namespace slipbench::train::train_network_test {
namespace {

struct TrainNetwork : slipbench::testing::SmallDatasetTest {
  NetworkTraining small(const std::string& recipe = "papillarray_gru") {
    NetworkTraining training;
    training.datasets = {dataset()};
    training.recipe = find_recipe(recipe);
    training.recipe.training.steps = 4;
    training.recipe.training.validate_every = 2;
    training.recipe.training.batch = 4;
    training.all = true;  // of the 24 trials, whatever their masks
    training.output = path("detector.onnx");
    return training;
  }
  std::string refusal(const NetworkTraining& training) {
    return refusal_of([&] { train_network(training); });
  }
};

// 24 trials: 5 judge, 4 of the other 19 validate (a fifth, rounded up). 0.4 s are ten stacks of 40 rows, so 15 trials are 150 frames.
TEST_F(TrainNetwork, WritesADetectorThatSaysWhatItHasSeen) {
  const NetworkTraining training = small();
  std::vector<std::size_t> steps;
  const NetworkSummary summary =
      train_network(training, [&](const MemberProgress& progress) { steps.push_back(progress.training.step); });
  EXPECT_THAT(steps, ElementsAre(2, 4));
  EXPECT_EQ(summary.trials, 24U);
  EXPECT_EQ(summary.judged, 5U);
  EXPECT_EQ(summary.validated, 4U);
  EXPECT_EQ(summary.learnt, 15U);
  EXPECT_EQ(summary.frames, 150U);
  const std::unique_ptr<network::Engine> engine = network::load_engine(training.output);
  const network::Description& description = engine->description();
  EXPECT_EQ(description.input.sensor, "papillarray");
  EXPECT_EQ(description.input.window, 40U);
  EXPECT_EQ(description.states.size(), 1U);
  EXPECT_EQ(description.threshold, summary.point.threshold);
  const auto trained = nlohmann::json::parse(description.trained);
  EXPECT_EQ(trained["recipe"], "papillarray_gru");
  EXPECT_EQ(trained["labels"], "latched");
  EXPECT_EQ(trained["seed"], 1);
  EXPECT_EQ(trained["trials_judged"].size(), 5U);
  EXPECT_EQ(trained["data_sha256"][0].get<std::string>().size(), 64U);
  // Those of the 15 learnt and the 4 validated; what judged is none of them.
  EXPECT_EQ(trained["sha256_seen"].size(), 19U);
  const DatasetReader reader(training.datasets.front());
  const auto seen = trained["sha256_seen"].get<std::vector<std::string>>();
  for (const auto& trial : trained["trials_judged"])
    EXPECT_EQ(std::ranges::count(seen, reader.trial_sha256(trial.get<std::size_t>())), 0);
  EXPECT_FALSE(std::filesystem::exists(training.output + ".checkpoint-0"));
  EXPECT_FALSE(std::filesystem::exists(training.output + ".unchecked"));
}

TEST_F(TrainNetwork, TheSameSeedGivesTheSameBytesAlsoWhereItIsKilled) {
  NetworkTraining training = small("papillarray_gru5");
  training.recipe.members = 2;
  train_network(training);
  const std::string whole = bytes_of(training.output);
  training.output = path("again.onnx");
  struct Killed {};
  std::size_t reports = 0;
  const auto killing = [&](const MemberProgress&) {
    if (++reports == 3) throw Killed{};
  };
  EXPECT_THROW(train_network(training, killing), Killed);  // within the second network
  EXPECT_FALSE(std::filesystem::exists(training.output));
  training.resume = true;
  train_network(training);
  EXPECT_EQ(bytes_of(training.output), whole);
  training.seed = 2;
  training.resume = false;
  train_network(training);  // which replaces a detector
  EXPECT_NE(bytes_of(training.output), whole);
}

TEST_F(TrainNetwork, RefusesWhatDoesNotFit) {
  NetworkTraining training = small();
  training.recipe = find_recipe("piezo_fft_gru");
  EXPECT_THAT(refusal(training), mentions({"papillarray", "1000 Hz", "piezo_skin", "10000 Hz", "signal"}));
  training = small();
  training.sensor = "thumb";
  EXPECT_THAT(refusal(training), mentions({"thumb"}));
  training = small();
  training.recipe.split = Split::material;
  EXPECT_THAT(refusal(training), mentions({"no material"}));
  training = small();
  training.datasets = {
      dataset({{"sweep.motion.speed", "[0.001 mm/s, 0.002 mm/s]"}}, "still.h5")};  // at most 0.4 um: nothing slips
  EXPECT_THAT(refusal(training), mentions({"150 hold", "0 slip"}));
  EXPECT_FALSE(std::filesystem::exists(training.output));
}

// Shares of 1/2, 1/4 and 1/4 of 24 trials: 12 learn, 6 validate and 6 judge.
TEST_F(TrainNetwork, KeepsToTheDatasetsOwnSplit) {
  NetworkTraining training = small();
  training.datasets = {dataset({{"split", "{by: trial, shares: [0.5, 0.25, 0.25]}"}}, "split.h5")};
  training.all = false;
  const NetworkSummary summary = train_network(training);
  EXPECT_TRUE(summary.own_split);
  EXPECT_EQ(summary.judged_from, training.datasets.front());
  EXPECT_EQ(summary.judged_part, "test");
  const auto trained = nlohmann::json::parse(network::load_engine(training.output)->description().trained);
  EXPECT_TRUE(trained["dataset_split"].get<bool>());
  const DatasetReader reader(training.datasets.front());
  EXPECT_EQ(reader.mask("train").size(), 12U);
  EXPECT_EQ(trained["trials_learnt"].get<std::vector<std::size_t>>(), reader.mask("train"));
  EXPECT_EQ(trained["trials_validated"].get<std::vector<std::size_t>>(), reader.mask("valid"));
  EXPECT_EQ(trained["trials_judged"].get<std::vector<std::size_t>>(), reader.mask("test"));
  EXPECT_EQ(trained["sha256_seen"].size(), 18U);
  training.divided = true;
  EXPECT_THAT(refusal(training), mentions({"split.h5", "--all"}));
}

// Twice 24 trials: 10 judge, a fifth of the other 38, rounded up, validates.
TEST_F(TrainNetwork, LearnsFromSeveralDatasets) {
  NetworkTraining training = small();
  training.datasets.push_back(dataset({{"seed", "6"}}, "more.h5"));
  const NetworkSummary summary = train_network(training);
  EXPECT_EQ(summary.judged, 10U);
  EXPECT_EQ(summary.validated, 8U);
  EXPECT_EQ(summary.learnt, 30U);
  const auto trained = nlohmann::json::parse(network::load_engine(training.output)->description().trained);
  EXPECT_EQ(trained["data_sha256"].size(), 2U);
  EXPECT_EQ(trained["sha256_seen"].size(), 38U);
  training.datasets.back() = dataset({{"sensors.pad", "{type: taxels, rows: 2, columns: 3, pitch: 4 mm}"}}, "other.h5");
  EXPECT_THAT(refusal(training), mentions({"other.h5", "trial 0", "no sensor"}));
}

// A constant answer has 1/2. The small scene slips within some 30 ms of its start, so nearly all of its frames can be told.
TEST_F(TrainNetwork, SlipGruLearnsFromAFewTrials) {
  NetworkTraining training = small("slip_gru");
  training.recipe.training.steps = 60;
  training.recipe.training.validate_every = 10;
  training.recipe.training.batch = 8;
  const NetworkSummary summary = train_network(training);
  EXPECT_GT(summary.held_out_accuracy, 0.8);
}

// A sensor of one's own: six taxels at 500 Hz, so that 10 ms are five samples.
TEST_F(TrainNetwork, SlipGruLearnsFromAnySensorOfUnits) {
  NetworkTraining training = small("slip_gru");
  training.datasets = {dataset({{"sensors.pad", "{type: taxels, rate: 500 Hz, rows: 2, columns: 3, pitch: 4 mm}"}}, "taxels.h5")};
  train_network(training);
  const std::unique_ptr<network::Engine> engine = network::load_engine(training.output);
  const network::Input& input = engine->description().input;
  EXPECT_EQ(input.sensor, "taxels");
  EXPECT_EQ(input.rate, 500.0);
  EXPECT_EQ(input.window, 5U);
  EXPECT_EQ(input.stride, 5U);
  EXPECT_THAT(input.spans, ElementsAre(5, 10, 20, 40, 80));
  EXPECT_EQ(input.scale.size(), 1U);  // common to all
}

// Weights are shared and what they make is pooled: units in another order are the same to it.
TEST(SlipGru, DoesNotCareWhichUnitIsWhich) {
  const NetworkShape& shape = find_recipe("slip_gru").network;
  const std::unique_ptr<Network> network = make_network(shape, 1);
  constexpr std::size_t frames = 4, units = 9;
  const std::size_t features = shape.inputs / units;
  std::vector<float> some(frames * shape.inputs), reversed(some.size());
  RandomStream random(1, 0, "units");
  for (float& x : some) x = static_cast<float>(random.normal());
  for (std::size_t i = 0; i < some.size(); ++i) {
    const std::size_t frame = i / shape.inputs, unit = i / features % units;
    reversed[(frame * units + units - 1 - unit) * features + i % features] = some[i];
  }
  EXPECT_THAT(network->logits(reversed), ::testing::Pointwise(::testing::FloatNear(1e-5F), network->logits(some)));
  std::swap(some[0], some[features + 1]);  // another feature of another unit
  EXPECT_THAT(network->logits(some),
              ::testing::Not(::testing::Pointwise(::testing::FloatNear(1e-5F), network->logits(reversed))));
}

TEST_F(TrainNetwork, KeepsAFileThatIsNoDetector) {
  const NetworkTraining training = small();
  std::ofstream(training.output) << "mine";
  EXPECT_THAT(refusal(training), mentions({"exists", "detector"}));
  EXPECT_EQ(bytes_of(training.output), "mine");
}

}  // namespace
}  // namespace slipbench::train::train_network_test
