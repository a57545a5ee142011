// The kernel against the reference, bit by bit.
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "detectors/hd/engine.h"
#include "detectors/hd/memories.h"
#include "sim/core/error.h"
#include "tests/detectors/hd/random_frames.h"

namespace slipbench::hd {
namespace {

// All models of one dimension and window.
std::vector<Model> all_models(std::size_t dimension, std::size_t window) {
  std::vector<Model> models;
  for (const Encoding encoding : {Encoding::spatial, Encoding::spatial_temporal, Encoding::graph_spatial_temporal}) {
    for (const bool context_driven : {false, true}) {
      for (const Ties ties : {Ties::one, Ties::zero}) {
        for (const Compat compat : {Compat::paper, Compat::published_core}) {
          models.push_back({dimension, window, encoding, context_driven, ties, compat});
        }
      }
    }
  }
  return models;
}

std::string text(const Model& model) {
  return "D " + std::to_string(model.dimension) + ", N " + std::to_string(model.window) + ", encoding " +
         std::to_string(static_cast<int>(model.encoding)) + ", context " + std::to_string(model.context_driven) + ", ties " +
         std::to_string(static_cast<int>(model.ties)) + ", compat " + std::to_string(static_cast<int>(model.compat));
}

// All results of an engine and an encoder, with a reset before frame `restart`. An empty vector
// stands for no query.
struct Outcome {
  std::vector<Decision> decisions;
  std::vector<Hypervector> queries;
};

Outcome outcome(Engine& engine, Encoder& encoder, const std::vector<Frame>& frames, std::size_t restart) {
  Outcome all;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    if (t == restart) {
      engine.reset();
      encoder.reset();
    }
    all.decisions.push_back(engine.update(frames[t]));
    const Hypervector* const query = encoder.encode(frames[t]);
    all.queries.push_back(query == nullptr ? Hypervector() : *query);
  }
  return all;
}

class KernelAgainstReference : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(KernelAgainstReference, SameDecisionsAndQueriesOnRandomFramesThroughResets) {
  const auto [dimension, window] = GetParam();
  std::uint64_t seed = 0;
  for (const Model& model : all_models(dimension, window)) {
    const Memories memories = random_memories(model, ++seed);
    const std::vector<Frame> frames = random_frames(2 * model.frames() + 8, seed);
    const std::size_t restart = model.frames() + 2;  // in a full window; then no window is full for N - 1 frames
    const Outcome expected = outcome(*make_reference(model, memories), *make_reference_encoder(model, memories), frames, restart);
    for (const KernelPath path : kernel_paths()) {
      const Outcome got =
          outcome(*make_kernel(model, memories, path), *make_kernel_encoder(model, memories, path), frames, restart);
      for (std::size_t t = 0; t < frames.size(); ++t) {
        ASSERT_EQ(got.decisions[t], expected.decisions[t]) << text(model) << ", path " << int(path) << ", frame " << t;
        ASSERT_EQ(got.queries[t], expected.queries[t]) << text(model) << ", path " << int(path) << ", frame " << t;
      }
    }
  }
}

// Dimensions below a word, at its edges, at the edge of 512 bits and above; windows shorter and
// longer than a short vector and than a word.
INSTANTIATE_TEST_SUITE_P(Shapes, KernelAgainstReference,
                         testing::Combine(testing::Values(8, 11, 63, 64, 65, 512, 1000, 1024), testing::Values(1, 2, 15)));
INSTANTIATE_TEST_SUITE_P(LongVectors, KernelAgainstReference, testing::Combine(testing::Values(2000), testing::Values(15)));
INSTANTIATE_TEST_SUITE_P(LongWindows, KernelAgainstReference,
                         testing::Combine(testing::Values(9, 65, 130), testing::Values(64, 140)));

// Every rotation up to D - 1 occurs, and rotated rows are longer than a block.
TEST(Kernel, AWindowAsLongAsTheVector) {
  for (const Compat compat : {Compat::paper, Compat::published_core}) {
    const Model model{.dimension = 577, .window = 577, .compat = compat};
    const Memories memories = random_memories(model, 1);
    const std::vector<Frame> frames = random_frames(model.window + 2, 2);
    const Outcome expected = outcome(*make_reference(model, memories), *make_reference_encoder(model, memories), frames, 0);
    for (const KernelPath path : kernel_paths()) {
      const Outcome got = outcome(*make_kernel(model, memories, path), *make_kernel_encoder(model, memories, path), frames, 0);
      ASSERT_EQ(got.decisions, expected.decisions) << text(model) << ", path " << int(path);
      ASSERT_EQ(got.queries, expected.queries) << text(model) << ", path " << int(path);
    }
  }
}

TEST(Kernel, RefusesFramesThatDoNotExistAndGoesOnAsIfTheyHadNotCome) {
  const Model model{.dimension = 64, .window = 2};
  const Memories memories = random_memories(model, 1);
  const std::vector<Frame> frames = random_frames(4, 2);
  Frame level = frames[0], context = frames[0];
  level.level[7] = 21;
  context.context = 4;
  for (const auto& engine : {make_reference(model, memories), make_kernel(model, memories)}) {
    const auto undisturbed = make_reference(model, memories);
    for (const Frame& frame : frames) {
      EXPECT_EQ(engine->update(frame), undisturbed->update(frame));
      EXPECT_THROW(engine->update(level), std::out_of_range);
      EXPECT_THROW(engine->update(context), std::out_of_range);
    }
  }
}

TEST(Kernel, RefusesMemoriesOfAnotherShape) {
  const Model model{.dimension = 64};
  Memories memories = random_memories(model, 1);
  memories.associative.pop_back();
  EXPECT_THROW(make_kernel(model, memories), InputError);
  EXPECT_THROW(make_reference(model, memories), InputError);
  EXPECT_NO_THROW(make_kernel_encoder(model, memories));
  EXPECT_THROW(make_kernel_encoder({.dimension = 65}, memories), InputError);
  EXPECT_THROW(make_kernel_encoder({.dimension = 64, .window = 0}, memories), InputError);
  EXPECT_THROW(make_kernel_encoder({.dimension = 7}, memories), InputError);
}

}  // namespace
}  // namespace slipbench::hd
