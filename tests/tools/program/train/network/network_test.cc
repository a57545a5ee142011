#include "tools/program/train/network/network.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/program/train/network/validation.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train::network_test {
namespace {

const TrainingOptions quick{.steps = 200, .batch = 8, .clip = 32, .learning_rate = 3e-3};

NetworkShape mlp(std::size_t inputs, std::size_t units, std::size_t layers) {
  NetworkShape shape{inputs, {}};
  for (std::size_t i = 0; i < layers; ++i) {
    shape.layers.emplace_back(Linear{units});
    shape.layers.emplace_back(Relu{});
  }
  shape.layers.emplace_back(Linear{2});
  return shape;
}
NetworkShape gru(std::size_t inputs, std::size_t units) { return {inputs, {Gru{units}, Gru{units}, Linear{2}}}; }
NetworkShape tcn(std::size_t inputs, std::size_t units, std::size_t kernel) {
  return {inputs, {Conv1d{units, kernel}, Relu{}, Conv1d{units, kernel}, Relu{}, Linear{2}}};
}

// One feature: normal with mean +1 in slip and -1 in hold, variance 1. Every tenth frame slips.
std::vector<FrameSequence> gaussians(std::size_t sequences, std::size_t frames, std::uint64_t seed) {
  RandomStream random(seed, 0, "gaussians");
  std::vector<FrameSequence> all(sequences);
  for (FrameSequence& sequence : all) {
    for (std::size_t frame = 0; frame < frames; ++frame) {
      sequence.label.push_back(frame % 10 == 3 ? 1 : 0);
      sequence.features.push_back(static_cast<float>(random.normal(sequence.label.back() != 0 ? 1.0 : -1.0, 1.0)));
    }
  }
  return all;
}

// Of two classes, by frame with an answer: the logarithm of the odds of slip.
std::vector<float> log_odds(const Network& network, std::span<const float> features) {
  const std::vector<float> logits = network.logits(features);
  std::vector<float> odds;
  for (std::size_t i = 0; i + 1 < logits.size(); i += 2) odds.push_back(logits[i + 1] - logits[i]);
  return odds;
}

Confusion judged(const Network& network, const std::vector<FrameSequence>& sequences, std::size_t from = 0) {
  Confusion counts{};
  for (const FrameSequence& sequence : sequences) {
    const std::vector<float> odds = log_odds(network, sequence.features);
    const std::size_t before = sequence.label.size() - odds.size();
    for (std::size_t frame = std::max(from, before); frame < sequence.label.size(); ++frame)
      count(counts, sequence.label[frame] != 0, odds[frame - before] > 0.0F);
  }
  return counts;
}

std::size_t learnt_values(const NetworkShape& shape) {
  std::size_t values = 0;
  for (const std::vector<float>& tensor : make_network(shape, 1)->state()) values += tensor.size();
  return values;
}

// Table I of the paper prints 22k, 23k, 352k, 3.6k, 51k, 51k, 405k and 1.6M parameters. Four layers and a linear one to two classes give all
// of them, and what libtorch holds is that many.
TEST(Network, HasThePublishedNumbersOfParameters) {
  const auto four = [](std::size_t inputs, const Layer& layer) {
    return NetworkShape{inputs, {layer, layer, layer, layer, Linear{2}}};
  };
  const std::vector<std::pair<NetworkShape, std::size_t>> table{
      {four(1, Gru{32}), 22434},          {four(12, Gru{32}), 23490},          {four(12, Gru{128}), 352002},
      {four(12, Linear{32}), 3650},       {four(12, Linear{128}), 51458},      {four(12, Conv1d{128, 1}), 51458},
      {four(12, Conv1d{128, 8}), 406274}, {four(12, Conv1d{128, 32}), 1622786}};
  for (const auto& [shape, parameters] : table) {
    EXPECT_EQ(parameter_count(shape), parameters);
    EXPECT_EQ(learnt_values(shape), parameters);
  }
  EXPECT_EQ(parameter_count(find_recipe("piezo_fft_gru").network), 23490U);
  EXPECT_EQ(parameter_count(find_recipe("piezo_mlp").network), 3650U);
}

// 640-1024-128, GRU 128, 256-128-2, a scale and an offset for each of four batch norms.
TEST(Network, ThePapillarraysHasTheNumberOfItsLayers) {
  const std::size_t stack = 641 * 1024 + 1025 * 128, recurrent = 3 * 128 * (128 + 128 + 2),
                    head = 129 * 256 + 257 * 128 + 129 * 2;
  EXPECT_EQ(parameter_count(find_recipe("papillarray_gru").network), stack + recurrent + head + 2 * (1024 + 128 + 256 + 128));
}

TEST(NetworkShape, KnowsItsHistory) {
  EXPECT_EQ(history_of(find_recipe("piezo_tcn").network), 29U);  // 1 + 4 (8 - 1)
  EXPECT_EQ(history_of(find_recipe("piezo_fft_gru").network), 1U);
  EXPECT_EQ(history_of(find_recipe("biotac_lstm").network), 5U);
  EXPECT_TRUE(carries_state(find_recipe("papillarray_gru").network));
  EXPECT_FALSE(carries_state(find_recipe("biotac_lstm").network));
  EXPECT_FALSE(carries_state(find_recipe("piezo_tcn").network));
  for (const Recipe& recipe : recipes())
    EXPECT_EQ(class_count(recipe.network), classes_of(recipe.classes, recipe.labels).size()) << recipe.name;
  EXPECT_THROW(static_cast<void>(class_count({12, {Reshape{{5}}}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(class_count({12, {Reshape{{3, 4}}}})), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(class_count({12, {Conv2d{}}})), std::invalid_argument);
}

// Of two nodes with an edge every degree is 2: all entries are 1/2.
TEST(NormalisedAdjacency, IsThatOfKipfAndWelling) {
  const std::vector<Edge> edges{{0, 1}};
  EXPECT_EQ(normalised_adjacency(2, edges), std::vector<double>(4, 1.0 / std::sqrt(4.0)));
}

// Who can tell nothing does best with even odds, which cost ln 2 a frame whatever its class, also where one class is rare, by either way of
// making both count alike.
TEST(Network, IgnoranceCostsLogTwo) {
  std::vector<FrameSequence> blind = gaussians(4, 200, 1);
  for (FrameSequence& sequence : blind) sequence.features.assign(sequence.features.size(), 0.0F);
  for (const Balance balance : {Balance::weights, Balance::drawing}) {
    TrainingOptions options = quick;
    options.balance = balance;
    if (balance == Balance::drawing) options.clip = 1;
    const std::unique_ptr<Network> network = make_network(mlp(1, 8, 2), 1);
    const std::vector<double> losses = network->train(blind, {}, options).losses;
    ASSERT_EQ(losses.size(), quick.steps);
    EXPECT_NEAR(std::accumulate(losses.end() - 50, losses.end(), 0.0) / 50.0, std::numbers::ln2, 0.01);
    // A clip of 32 frames has 3 or 4 of the rare class, so the odds wander by a few tenths.
    EXPECT_NEAR(log_odds(*network, std::vector<float>{0.0F})[0], 0.0, 0.3);
  }
}

// Bayes' rule calls slip where x > 0, which is right for a share Phi(1) = 0.8413 of either class. 2,000 slip frames give it to within 0.8 %
// (one standard deviation), their half counts; learning from a finite set costs a little more. Its log odds are 2 x.
TEST(Network, ComesUpToBayesErrorAlsoOfARareClass) {
  const std::unique_ptr<Network> network = make_network(mlp(1, 16, 2), 1);
  TrainingOptions options = quick;
  options.steps = 600;
  network->train(gaussians(20, 1000, 2), {}, options);
  EXPECT_NEAR(balanced_slip_accuracy(judged(*network, gaussians(20, 1000, 3))), 0.8413, 0.015);
  EXPECT_NEAR(log_odds(*network, std::vector<float>{1.0F})[0], 2.0, 0.5);
  EXPECT_NEAR(log_odds(*network, std::vector<float>{-1.0F})[0], -2.0, 0.5);
}

// No straight line tells these apart.
TEST(Network, LearnsExclusiveOr) {
  std::vector<FrameSequence> sequences(1);
  for (std::size_t frame = 0; frame < 64; ++frame) {
    const bool a = frame % 2 != 0, b = frame / 2 % 2 != 0;
    sequences[0].features.insert(sequences[0].features.end(), {a ? 1.0F : -1.0F, b ? 1.0F : -1.0F});
    sequences[0].label.push_back(a != b ? 1 : 0);
  }
  for (const Optimiser optimiser : {Optimiser::rmsprop, Optimiser::adam}) {
    TrainingOptions options = quick;
    options.optimiser = optimiser;
    const std::unique_ptr<Network> network = make_network(mlp(2, 16, 2), 1);
    network->train(sequences, {}, options);
    EXPECT_EQ(balanced_slip_accuracy(judged(*network, sequences)), 1.0);
  }
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
    network->train(sequences, {}, options);
    return balanced_slip_accuracy(judged(*network, sequences, 1));
  };
  EXPECT_EQ(learnt(mlp(1, 8, 2)), 0.5);
  EXPECT_EQ(learnt(gru(1, 8)), 1.0);
  EXPECT_EQ(learnt({1, {Lstm{8}, Linear{2}}}), 1.0);
  EXPECT_EQ(learnt({1, {Reshape{{1, 1, 1}}, ConvLstm{8, 1}, Flatten{}, Linear{2}}}), 1.0);
  // Two layers of kernel 6 see eleven frames, so their two answers of twelve frames know the first or do not: of the later one half is guessed.
  EXPECT_DOUBLE_EQ(learnt(tcn(1, 8, 6)), 0.75);
}

// What comes later changes nothing that was said before, and what comes now does.
TEST(Network, IsCausal) {
  const FrameSequence sequence = gaussians(1, 40, 4).front();
  std::vector<float> changed = sequence.features;
  changed[30] += 1.0F;
  for (const NetworkShape& shape : {mlp(1, 8, 2), tcn(1, 8, 4), gru(1, 8), NetworkShape{1, {Lstm{8}, Last{5}, Linear{2}}}}) {
    const std::unique_ptr<Network> network = make_network(shape, 1);
    const std::vector<float> before = network->logits(sequence.features), after = network->logits(changed);
    const std::size_t first = history_of(shape) - 1;  // the frame of the first answer
    ASSERT_EQ(before.size(), 2 * (40 - first));
    for (std::size_t frame = first; frame < 30; ++frame) EXPECT_EQ(before[2 * (frame - first)], after[2 * (frame - first)]);
    EXPECT_NE(before[2 * (30 - first)], after[2 * (30 - first)]);
  }
}

// A frame that is masked teaches nothing: here all masked ones say the opposite.
TEST(Network, IgnoresMaskedFrames) {
  std::vector<FrameSequence> sequences = gaussians(8, 400, 7);
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    for (std::size_t t = 0; t < 400; t += 2) {
      sequences[s].features[t] = sequences[s].label[t] != 0 ? -9.0F : 9.0F;
      sequences[s].label[t] = masked;
    }
  }
  const std::unique_ptr<Network> network = make_network(mlp(1, 8, 2), 1);
  network->train(sequences, {}, quick);
  EXPECT_GT(balanced_slip_accuracy(judged(*network, gaussians(20, 400, 8))), 0.8);
}

// With onset_frames 5 a slip of 30 frames teaches by its frames 1 to 5, 10, 20 and 30: as if the others were masked.
TEST(Network, TheBeginningOfASlipTeachesAndEachTenthFrame) {
  std::vector<FrameSequence> sequences = gaussians(4, 40, 5);
  for (FrameSequence& sequence : sequences) std::fill(std::fill_n(sequence.label.begin(), 10, 0), sequence.label.end(), 1);
  const auto trained = [&](std::size_t onset_frames) {
    const std::unique_ptr<Network> network = make_network(gru(1, 8), 1);
    TrainingOptions options = quick;
    options.steps = 20;
    options.onset_frames = onset_frames;
    network->train(sequences, {}, options);
    return network->state();
  };
  const auto all = trained(0), some = trained(5);
  for (FrameSequence& sequence : sequences) {
    for (std::size_t run = 6; run <= 30; ++run) {
      if (run % 10 != 0) sequence.label[9 + run] = masked;
    }
  }
  EXPECT_EQ(trained(0), some);
  EXPECT_NE(all, some);
}

TEST(Network, TheSameSeedGivesTheSameWeights) {
  const std::vector<FrameSequence> sequences = gaussians(4, 100, 5);
  const auto trained = [&](std::uint64_t seed, std::uint64_t clips) {
    const std::unique_ptr<Network> network = make_network(gru(1, 8), seed);
    TrainingOptions options = quick;
    options.steps = 20;
    options.seed = clips;
    network->train(sequences, {}, options);
    return network->state();
  };
  const auto first = trained(1, 1);
  auto beside = std::async(std::launch::async, trained, 1, 1);  // two at a time
  EXPECT_EQ(trained(1, 1), first);
  EXPECT_EQ(beside.get(), first);
  EXPECT_NE(trained(2, 1), first);
  EXPECT_NE(trained(1, 2), first);
}

// On frames that mean the opposite the first state judged is the best, and three worse ones end it.
TEST(Network, KeepsTheBestStateAndEndsEarly) {
  const std::vector<FrameSequence> learnt = gaussians(4, 200, 9);
  std::vector<FrameSequence> opposite = gaussians(4, 200, 10);
  for (FrameSequence& sequence : opposite) {
    for (std::uint8_t& label : sequence.label) label = 1 - label;
  }
  TrainingOptions options = quick;
  options.validate_every = 10;
  options.patience = 3;
  const std::unique_ptr<Network> network = make_network(mlp(1, 8, 2), 1);
  std::vector<double> validations;
  const TrainingResult result = network->train(learnt, opposite, options, {}, [&](const TrainingProgress& progress) {
    validations.push_back(*progress.validation);
    EXPECT_EQ(progress.step, 10 * validations.size());
    EXPECT_EQ(progress.best, std::ranges::max_element(validations) == validations.end() - 1);  // the earliest of equals
  });
  EXPECT_LT(result.losses.size(), options.steps);
  EXPECT_EQ(result.validation, *std::ranges::max_element(validations));
  EXPECT_EQ(validations.size(), result.best_step / 10 + 3);
  EXPECT_DOUBLE_EQ(balanced_slip_accuracy(judged(*network, opposite)), result.validation);
}

// Killed after any report and gone on with, also with running means and an optimiser that remembers.
class Resumed : public slipbench::testing::FolderTest {};

TEST_F(Resumed, GivesTheSameBytes) {
  const std::vector<FrameSequence> sequences = gaussians(6, 100, 11), validation = gaussians(2, 100, 12);
  struct Killed {};
  for (const Optimiser optimiser : {Optimiser::rmsprop, Optimiser::adam}) {
    TrainingOptions options = quick;
    options.optimiser = optimiser;
    options.steps = 40;
    options.validate_every = 10;
    const NetworkShape shape{1, {Linear{8}, BatchNorm{}, Relu{}, Gru{4}, Linear{2}}};
    const std::unique_ptr<Network> whole = make_network(shape, 1);
    const TrainingResult result = whole->train(sequences, validation, options);
    const std::string file = path("checkpoint");
    for (std::size_t killed = 1; killed <= 3; ++killed) {
      std::filesystem::remove(file);
      const Checkpoint first{file, "same", false}, second{file, "same", true};
      std::size_t reports = 0;
      EXPECT_THROW(make_network(shape, 1)->train(sequences, validation, options, first,
                                                 [&](const TrainingProgress&) {
                                                   if (++reports == killed) throw Killed{};
                                                 }),
                   Killed);
      const std::unique_ptr<Network> resumed = make_network(shape, 1);
      const TrainingResult again = resumed->train(sequences, validation, options, second);
      EXPECT_EQ(resumed->state(), whole->state());
      EXPECT_EQ(again.losses, result.losses);
      EXPECT_EQ(again.best_step, result.best_step);
    }
    EXPECT_THROW(make_network(shape, 1)->train(sequences, validation, options, {file, "another", true}), InputError);
    std::ofstream(file) << "no checkpoint";
    EXPECT_THROW(make_network(shape, 1)->train(sequences, validation, options, {file, "same", true}), InputError);
    std::filesystem::remove(file);
  }
}

// A bit of any byte, and an end that is missing: libtorch itself takes changed weights.
TEST_F(Resumed, NotFromADamagedCheckpoint) {
  const std::vector<FrameSequence> sequences = gaussians(6, 100, 11);
  TrainingOptions options = quick;
  options.steps = 2;
  const NetworkShape shape{1, {Linear{8}, Relu{}, Linear{2}}};
  const Checkpoint whole{path("checkpoint"), "same", false}, resumed{path("checkpoint"), "same", true};
  make_network(shape, 1)->train(sequences, {}, options, whole);
  const std::string bytes = bytes_of(whole.path);
  ASSERT_GT(bytes.size(), 1000U);
  const auto refusal = [&](const std::string& content) {
    std::ofstream(whole.path, std::ios::binary) << content;
    return refusal_of([&] { make_network(shape, 1)->train(sequences, {}, options, resumed); });
  };
  for (std::size_t part = 0; part < 20; ++part) {
    std::string damaged = bytes;
    damaged[part * bytes.size() / 20] ^= 4;
    EXPECT_THAT(refusal(damaged), mentions({"checkpoint"})) << part;
  }
  EXPECT_THAT(refusal(bytes.substr(0, bytes.size() / 2)), HasSubstr("is damaged"));
  std::ofstream(whole.path, std::ios::binary) << bytes;
  EXPECT_NO_THROW(make_network(shape, 1)->train(sequences, {}, options, resumed));
}

// Hours of training are not written over by the same command.
TEST_F(Resumed, OrRefusedWhereACheckpointIsLeft) {
  const std::vector<FrameSequence> sequences = gaussians(6, 100, 11);
  TrainingOptions options = quick;
  options.steps = 2;
  const NetworkShape shape{1, {Linear{8}, Relu{}, Linear{2}}};
  const Checkpoint checkpoint{path("checkpoint"), "same", false};
  make_network(shape, 1)->train(sequences, {}, options, checkpoint);
  const std::string bytes = bytes_of(checkpoint.path);
  EXPECT_THAT(refusal_of([&] { make_network(shape, 1)->train(sequences, {}, options, checkpoint); }), mentions({"--resume"}));
  EXPECT_EQ(bytes_of(checkpoint.path), bytes);
}

// As if its last frame stood still behind it and were masked; 32 is a clip.
TEST(Network, AShortSequenceCutsNoOthersClips) {
  const std::vector<FrameSequence> both = gaussians(2, 50, 6);
  FrameSequence brief = both[1];
  brief.features.resize(10);
  brief.label.resize(10);
  FrameSequence padded = brief;
  padded.features.resize(32, brief.features.back());
  padded.label.resize(32, masked);
  for (const Balance balance : {Balance::weights, Balance::drawing}) {
    TrainingOptions options = quick;
    options.balance = balance;
    const auto losses = [&](const FrameSequence& second) {
      return make_network(mlp(1, 8, 2), 1)->train(std::vector{both[0], second}, {}, options).losses;
    };
    EXPECT_EQ(losses(brief), losses(padded));
  }
}

// The target of a smoothed label is 1 - s/2 and s/2, so the best log odds of what can be told for certain are ln((2 - s)/s): for s = 0.2, 2.197.
TEST(Network, SmoothedLabelsBoundTheOdds) {
  std::vector<FrameSequence> sequences(2);
  for (std::size_t t = 0; t < 64; ++t) {
    for (FrameSequence& sequence : sequences) {
      sequence.label.push_back(t % 2 != 0 ? 1 : 0);
      sequence.features.push_back(t % 2 != 0 ? 1.0F : -1.0F);
    }
  }
  TrainingOptions options = quick;
  options.label_smoothing = 0.2;
  options.steps = 600;
  const std::unique_ptr<Network> network = make_network(mlp(1, 8, 2), 1);
  network->train(sequences, {}, options);
  EXPECT_NEAR(log_odds(*network, std::vector<float>{1.0F})[0], std::log(1.8 / 0.2), 0.1);
}

TEST(Network, NeedsBothClasses) {
  std::vector<FrameSequence> sequences = gaussians(2, 50, 6);
  const std::unique_ptr<Network> network = make_network(mlp(1, 8, 2), 1);
  sequences[0].features.pop_back();
  EXPECT_THROW(network->train(sequences, {}, quick), std::invalid_argument);
  sequences = {{{0.0F, 1.0F}, {0, 0}}};
  EXPECT_THROW(network->train(sequences, {}, quick), std::invalid_argument);
}

// Examples of another group than it learns from do not teach it: there the feature means the opposite, and it is wrong about all of them.
TEST(JudgeFold, LearnsOnlyFromItsGroups) {
  std::vector<FoldExample> examples;
  for (std::size_t i = 0; i < 12; ++i) {
    FrameSequence sequence;
    for (std::size_t frame = 0; frame < 40; ++frame) {
      sequence.label.push_back(frame / 10 % 2 == 0 ? 0 : 1);
      sequence.features.push_back((sequence.label.back() != 0) == (i % 2 == 0) ? 1.0F : -1.0F);
    }
    examples.push_back({sequence, i % 2});
  }
  std::vector<std::size_t> groups;
  for (const FoldExample& example : examples) groups.push_back(example.group);
  for (const double validated : {0.0, 0.3}) {
    Validation validation{mlp(1, 8, 1), quick, validated, [](std::size_t group) { return group == 0; }};
    const std::vector<Confusion> counts = counts_of(examples, called_in_fold(examples, folds(groups, 3, 1), 1, validation));
    ASSERT_EQ(counts.size(), 2U);
    EXPECT_EQ(balanced_slip_accuracy(counts[0]), 1.0);
    EXPECT_EQ(balanced_slip_accuracy(counts[1]), 0.0);
    EXPECT_EQ(samples_in(counts[1], PadState::gross, PadState::non_slip), 2U * 20U);  // of the two in the fold, half of 40 frames
  }
}

}  // namespace
}  // namespace slipbench::train::network_test
