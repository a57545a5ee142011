#include "tools/program/learn/network.h"

#include <cmath>
#include <future>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "sim/core/random.h"
#include "tools/program/learn/validation.h"

namespace slipbench::learn::network_test {
namespace {

constexpr TrainingOptions quick{.steps = 200, .batch = 8, .clip = 32, .learning_rate = 3e-3};

// One feature: normal with mean +1 in slip and -1 in hold, variance 1. Every tenth frame slips.
std::vector<FrameSequence> gaussians(std::size_t sequences, std::size_t frames, std::uint64_t seed) {
  RandomStream random(seed, 0, "gaussians");
  std::vector<FrameSequence> all(sequences);
  for (FrameSequence& sequence : all) {
    for (std::size_t frame = 0; frame < frames; ++frame) {
      sequence.slip.push_back(frame % 10 == 3 ? 1 : 0);
      sequence.features.push_back(static_cast<float>(random.normal(sequence.slip.back() != 0 ? 1.0 : -1.0, 1.0)));
    }
  }
  return all;
}

Counts judged(const Network& network, const std::vector<FrameSequence>& sequences, std::size_t from = 0) {
  Counts counts;
  for (const FrameSequence& sequence : sequences) {
    const std::vector<float> odds = network.log_odds(sequence.features);
    for (std::size_t frame = from; frame < odds.size(); ++frame) counts.add(sequence.slip[frame] != 0, odds[frame] > 0.0F);
  }
  return counts;
}

// Table I of the paper prints 22k, 23k, 352k, 3.6k, 51k, 51k, 405k and 1.6M parameters. Four layers and a linear one to two classes give all
// of them, and what libtorch holds is that many.
TEST(Network, HasThePublishedNumbersOfParameters) {
  using enum Architecture;
  const std::vector<std::pair<NetworkShape, std::size_t>> table{{{.architecture = gru, .inputs = 1}, 22434},
                                                                {{.architecture = gru}, 23490},
                                                                {{.architecture = gru, .dim = 128}, 352002},
                                                                {{.architecture = mlp}, 3650},
                                                                {{.architecture = mlp, .dim = 128}, 51458},
                                                                {{.architecture = tcn, .dim = 128, .kernel = 1}, 51458},
                                                                {{.architecture = tcn, .dim = 128, .kernel = 8}, 406274},
                                                                {{.architecture = tcn, .dim = 128, .kernel = 32}, 1622786}};
  for (const auto& [shape, parameters] : table) {
    EXPECT_EQ(parameter_count(shape), parameters);
    EXPECT_EQ(make_network(shape, 1)->weights().size(), parameters);
  }
}

// Who can tell nothing does best with even odds, which cost ln 2 a frame whatever its class, also where one class is rare.
TEST(Network, IgnoranceCostsLogTwo) {
  std::vector<FrameSequence> blind = gaussians(4, 200, 1);
  for (FrameSequence& sequence : blind) sequence.features.assign(sequence.features.size(), 0.0F);
  const std::unique_ptr<Network> network = make_network({.inputs = 1, .dim = 8, .layers = 2}, 1);
  const std::vector<double> losses = network->train(blind, quick);
  ASSERT_EQ(losses.size(), quick.steps);
  EXPECT_NEAR(std::accumulate(losses.end() - 50, losses.end(), 0.0) / 50.0, std::numbers::ln2, 0.01);
  // A clip of 32 frames has 3 or 4 of the rare class, so the odds wander by a few tenths.
  EXPECT_NEAR(network->log_odds(std::vector<float>{0.0F})[0], 0.0, 0.3);
}

// Bayes' rule calls slip where x > 0, which is right for a share Phi(1) = 0.8413 of either class. 2,000 slip frames give it to within 0.8 %
// (one standard deviation), their half counts; learning from a finite set costs a little more. Its log odds are 2 x.
TEST(Network, ComesUpToBayesErrorAlsoOfARareClass) {
  const std::unique_ptr<Network> network = make_network({.inputs = 1, .dim = 16, .layers = 2}, 1);
  TrainingOptions options = quick;
  options.steps = 600;
  network->train(gaussians(20, 1000, 2), options);
  EXPECT_NEAR(judged(*network, gaussians(20, 1000, 3)).balanced_accuracy(), 0.8413, 0.015);
  EXPECT_NEAR(network->log_odds(std::vector<float>{1.0F})[0], 2.0, 0.5);
  EXPECT_NEAR(network->log_odds(std::vector<float>{-1.0F})[0], -2.0, 0.5);
}

// No straight line tells these apart.
TEST(Network, LearnsExclusiveOr) {
  std::vector<FrameSequence> sequences(1);
  for (std::size_t frame = 0; frame < 64; ++frame) {
    const bool a = frame % 2 != 0, b = frame / 2 % 2 != 0;
    sequences[0].features.insert(sequences[0].features.end(), {a ? 1.0F : -1.0F, b ? 1.0F : -1.0F});
    sequences[0].slip.push_back(a != b ? 1 : 0);
  }
  const std::unique_ptr<Network> network = make_network({.inputs = 2, .dim = 16, .layers = 2}, 1);
  network->train(sequences, quick);
  EXPECT_EQ(judged(*network, sequences).balanced_accuracy(), 1.0);
}

// The first frame tells, the later ones are empty: a network without memory knows nothing in them, one with a memory all.
TEST(Network, OnlyAMemoryTellsThePast) {
  std::vector<FrameSequence> sequences;
  for (std::size_t i = 0; i < 16; ++i) {
    FrameSequence sequence{std::vector<float>(12, 0.0F), std::vector<std::uint8_t>(12, i % 2 != 0 ? 1 : 0)};
    sequence.features[0] = i % 2 != 0 ? 1.0F : -1.0F;
    sequences.push_back(sequence);
  }
  TrainingOptions options = quick;
  options.learning_rate = 5e-3;
  const auto learnt = [&](const NetworkShape& shape) {
    const std::unique_ptr<Network> network = make_network(shape, 1);
    network->train(sequences, options);
    return judged(*network, sequences, 1).balanced_accuracy();
  };
  EXPECT_EQ(learnt({.inputs = 1, .dim = 8, .layers = 2}), 0.5);
  EXPECT_EQ(learnt({.architecture = Architecture::gru, .inputs = 1, .dim = 8, .layers = 2}), 1.0);
  // Two layers of kernel 8 see 15 frames, of kernel 3 five: of the eleven later frames four are told, of the others half are guessed.
  EXPECT_EQ(learnt({.architecture = Architecture::tcn, .inputs = 1, .dim = 8, .layers = 2, .kernel = 8}), 1.0);
  EXPECT_DOUBLE_EQ(learnt({.architecture = Architecture::tcn, .inputs = 1, .dim = 8, .layers = 2, .kernel = 3}), 15.0 / 22.0);
}

// What comes later changes nothing that was said before, and what comes now does.
TEST(Network, IsCausal) {
  using enum Architecture;
  const FrameSequence sequence = gaussians(1, 40, 4).front();
  std::vector<float> changed = sequence.features;
  changed[30] += 1.0F;
  for (const Architecture architecture : {mlp, tcn, gru}) {
    const std::unique_ptr<Network> network =
        make_network({.architecture = architecture, .inputs = 1, .dim = 8, .layers = 2, .kernel = 4}, 1);
    const std::vector<float> before = network->log_odds(sequence.features), after = network->log_odds(changed);
    ASSERT_EQ(before.size(), 40U);
    for (std::size_t frame = 0; frame < 30; ++frame) EXPECT_EQ(before[frame], after[frame]);
    EXPECT_NE(before[30], after[30]);
  }
}

TEST(Network, TheSameSeedGivesTheSameWeights) {
  const std::vector<FrameSequence> sequences = gaussians(4, 100, 5);
  const auto trained = [&](std::uint64_t seed, std::uint64_t clips) {
    const std::unique_ptr<Network> network = make_network({.architecture = Architecture::gru, .inputs = 1, .dim = 8}, seed);
    TrainingOptions options = quick;
    options.steps = 20;
    options.seed = clips;
    network->train(sequences, options);
    return network->weights();
  };
  const std::vector<float> first = trained(1, 1);
  auto beside = std::async(std::launch::async, trained, 1, 1);  // two at a time
  EXPECT_EQ(trained(1, 1), first);
  EXPECT_EQ(beside.get(), first);
  EXPECT_NE(trained(2, 1), first);
  EXPECT_NE(trained(1, 2), first);
}

TEST(Network, NeedsBothClasses) {
  std::vector<FrameSequence> sequences = gaussians(2, 50, 6);
  const std::unique_ptr<Network> network = make_network({.inputs = 1, .dim = 8}, 1);
  sequences[0].features.pop_back();
  EXPECT_THROW(network->train(sequences, quick), std::invalid_argument);
  sequences = {{{0.0F, 1.0F}, {0, 0}}};
  EXPECT_THROW(network->train(sequences, quick), std::invalid_argument);
}

// Examples of another group than it learns from do not teach it: there the feature means the opposite, and it is wrong about all of them.
TEST(JudgeFold, LearnsOnlyFromItsGroups) {
  std::vector<Example> examples;
  for (std::size_t i = 0; i < 12; ++i) {
    FrameSequence sequence;
    for (std::size_t frame = 0; frame < 40; ++frame) {
      sequence.slip.push_back(frame / 10 % 2 == 0 ? 0 : 1);
      sequence.features.push_back((sequence.slip.back() != 0) == (i % 2 == 0) ? 1.0F : -1.0F);
    }
    examples.push_back({sequence, i % 2});
  }
  std::vector<std::size_t> groups;
  for (const Example& example : examples) groups.push_back(example.group);
  Validation validation{{.inputs = 1, .dim = 8, .layers = 1}, quick, [](std::size_t group) { return group == 0; }};
  const std::vector<Counts> counts = judge_fold(examples, folds(groups, 3, 1), 1, validation);
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].balanced_accuracy(), 1.0);
  EXPECT_EQ(counts[1].balanced_accuracy(), 0.0);
  EXPECT_EQ(counts[1].slip_called_hold, 2U * 20U);  // of the two in the fold, half of 40 frames
}

}  // namespace
}  // namespace slipbench::learn::network_test
