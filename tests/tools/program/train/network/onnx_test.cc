// What the ONNX file says against libtorch's own answers, through the engine that runs it in a loop.
#include <cmath>

#include <gtest/gtest.h>

#include "detectors/network/engine.h"
#include "sim/core/error.h"
#include "sim/core/random.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/base/files/output_file.h"
#include "tools/program/train/network/network.h"
#include "tools/program/train/recipes/recipe.h"

namespace slipbench::train::onnx_test {
namespace {

constexpr std::size_t frames = 12;

FrameSequence noise(std::size_t inputs, std::size_t classes, std::uint64_t seed) {
  RandomStream random(seed, 0, "noise");
  FrameSequence sequence;
  for (std::size_t t = 0; t < frames; ++t) {
    sequence.label.push_back(static_cast<std::uint8_t>((t + frames - 1) % classes));
    for (std::size_t i = 0; i < inputs; ++i) sequence.features.push_back(static_cast<float>(random.normal()));
  }
  return sequence;
}

// A few steps, so that the running means of a BatchNorm are not those that it began with.
std::unique_ptr<Network> taught(const NetworkShape& shape, std::uint64_t seed) {
  std::unique_ptr<Network> network = make_network(shape, seed);
  const std::vector<FrameSequence> sequences{noise(shape.inputs, class_count(shape), 1),
                                             noise(shape.inputs, class_count(shape), 2)};
  TrainingOptions options{.steps = 3, .batch = 4, .clip = 4};
  options.balance = Balance::drawing;
  network->train(sequences, {}, options);
  return network;
}

network::Description description(const NetworkShape& shape) {
  network::Description one;
  one.input.sensor = "piezo_skin";
  one.input.rate = 100.0;
  one.input.channels = {{"signal", {}}};
  one.input.history = history_of(shape);
  for (std::size_t c = 0; c < class_count(shape); ++c)
    one.classes.push_back({"c" + std::to_string(c), c == 0 ? PadState::non_slip : PadState::gross});
  return one;
}

struct Onnx : slipbench::testing::FolderTest {
  void expect_same(const std::string& name, const NetworkShape& shape, std::size_t members = 1) {
    SCOPED_TRACE(name);
    std::vector<std::unique_ptr<Network>> networks;
    std::vector<std::vector<std::vector<float>>> states;
    for (std::size_t m = 0; m < members; ++m) states.push_back(networks.emplace_back(taught(shape, 1 + m))->state());
    const std::string file = path(name + ".onnx");
    write_text_file(file, onnx_model(shape, states, description(shape)));
    const std::unique_ptr<network::Engine> engine = network::load_engine(file);
    const std::size_t history = history_of(shape), classes = class_count(shape);
    ASSERT_EQ(engine->inputs(), history * shape.inputs);
    const FrameSequence sequence = noise(shape.inputs, classes, 3);
    for (int trial = 0; trial < 2; ++trial) {  // what is carried is gone after a reset
      engine->reset();
      for (std::size_t t = 0; t + history <= frames; ++t) {
        const std::span<const float> said =
            engine->run(std::span(sequence.features).subspan(t * shape.inputs, history * shape.inputs));
        ASSERT_EQ(said.size(), classes);
        std::vector<double> expected(classes, 0.0);
        for (const std::unique_ptr<Network>& network : networks) {
          const std::vector<float> logits = network->logits(sequence.features);
          double sum = 0.0;
          for (std::size_t c = 0; c < classes; ++c) sum += std::exp(double{logits[t * classes + c]});
          for (std::size_t c = 0; c < classes; ++c) {
            const double logit = double{logits[t * classes + c]};
            expected[c] += members == 1 ? logit : std::exp(logit) / sum / static_cast<double>(members);
          }
        }
        for (std::size_t c = 0; c < classes; ++c) EXPECT_NEAR(double{said[c]}, expected[c], 1e-5) << "frame " << t;
      }
    }
  }
};

TEST_F(Onnx, SaysWhatLibtorchSays) {
  expect_same("linear", {5, {Linear{7}, Relu{}, Linear{6}, Tanh{}, Linear{3}}});
  expect_same("batch_norm", {5, {Linear{7}, BatchNorm{}, Relu{}, Linear{2}}});
  expect_same("gru", {5, {Gru{4}, Gru{3}, Linear{2}}});
  expect_same("lstm", {5, {Lstm{4}, Lstm{3}, Linear{2}}});
  expect_same("gru_of_five", {5, {Gru{4}, Gru{3}, Last{5}, Linear{2}}});
  expect_same("lstm_of_five", {5, {Lstm{4}, Lstm{3}, Last{5}, Linear{2}}});
  expect_same("conv1d", {5, {Conv1d{4, 3}, Relu{}, Conv1d{3, 4}, Linear{2}}});
  expect_same("conv1d_gru", {5, {Conv1d{4, 3}, Gru{3}, Linear{2}}});
  expect_same("conv2d", {40, {Reshape{{2, 5, 4}}, Conv2d{3, 3, 1}, BatchNorm{}, Relu{}, MaxPool{}, Flatten{}, Linear{2}}});
  expect_same("no_padding", {40, {Reshape{{5, 4, 2}}, Permute{{2, 0, 1}}, Conv2d{3, 3, 0}, Tanh{}, GlobalAverage{}, Linear{2}}});
  expect_same("graph", {8,
                        {Reshape{{4, 2}}, GraphConvolution{3, normalised_adjacency(4, std::vector<Edge>{{0, 1}, {1, 2}})},
                         BatchNorm{1}, Relu{}, Flatten{}, Linear{2}}});
  expect_same(
      "units",
      {15, {Reshape{{5, 3}}, BatchNorm{1}, Linear{4}, PoolUnits{true}, Linear{3}, Relu{}, PoolUnits{}, Gru{3}, Linear{2}}});
  expect_same("conv_lstm", {24, {Reshape{{2, 4, 3}}, ConvLstm{3, 3}, ConvLstm{2, 3}, Last{5}, GlobalAverage{}, Linear{2}}});
  expect_same("carried_conv_lstm", {24, {Reshape{{2, 4, 3}}, ConvLstm{3, 3}, GlobalAverage{}, Linear{2}}});
}

TEST_F(Onnx, AveragesAnEnsemblesProbabilities) {
  expect_same("ensemble", {5, {Linear{4}, BatchNorm{}, Relu{}, Gru{3}, Linear{3}}}, 3);
}

TEST_F(Onnx, RefusesAnotherNetworksState) {
  const NetworkShape shape{5, {Gru{4}, Linear{2}}}, other{5, {Gru{3}, Linear{2}}};
  const std::vector<std::vector<std::vector<float>>> states{make_network(other, 1)->state()};
  EXPECT_THROW(onnx_model(shape, states, description(shape)), std::invalid_argument);
}

TEST_F(Onnx, TheSameNetworkGivesTheSameBytes) {
  const NetworkShape shape{5, {Gru{4}, Linear{2}}};
  const std::vector<std::vector<std::vector<float>>> states{make_network(shape, 1)->state()};
  EXPECT_EQ(onnx_model(shape, states, description(shape)), onnx_model(shape, states, description(shape)));
}

}  // namespace
}  // namespace slipbench::train::onnx_test
