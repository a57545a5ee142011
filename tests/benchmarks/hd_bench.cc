// Time of one sample through the hyperdimensional classifier: run with --benchmark_repetitions=9
// and read the medians.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "detectors/hd/engine.h"
#include "detectors/hd/memories.h"
#include "tests/detectors/hd/random_frames.h"

namespace slipbench::hd {
namespace {

constexpr std::uint64_t seed = 1;

constexpr std::size_t frame_count = 4096;

// Feeds random frames, more than a branch predictor can learn.
void update(benchmark::State& state, Engine& engine) {
  const std::vector<Frame> frames = random_frames(frame_count, seed);
  std::size_t t = 0;
  for (auto _ : state) benchmark::DoNotOptimize(engine.update(frames[t++ % frame_count]));
}

void kernel(benchmark::State& state, KernelPath path, Compat compat) {
  const Model model{.compat = compat};
  update(state, *make_kernel(model, random_memories(model, seed), path));
}

void reference(benchmark::State& state, Compat compat) {
  const Model model{.compat = compat};
  update(state, *make_reference(model, random_memories(model, seed)));
}

void quantised(benchmark::State& state) {
  std::vector<float> displacement(3 * pillar_count);
  for (std::size_t i = 0; i < displacement.size(); ++i) displacement[i] = static_cast<float>(i % 7) * 2e-4F;
  for (auto _ : state) {
    benchmark::DoNotOptimize(displacement.data());
    benchmark::DoNotOptimize(quantise(displacement, Quantiser::fixed_point));
  }
}

void trained(benchmark::State& state) {
  const Model model;
  const Memories memories = random_memories(model, seed);
  Prototypes prototypes(model, memories);
  const auto encoder = make_kernel_encoder(model, memories);
  const std::vector<Frame> frames = random_frames(frame_count, seed);
  std::size_t t = 0;
  while (t < model.window) encoder->encode(frames[t++]);
  for (auto _ : state) {
    const Frame& frame = frames[t++ % frame_count];
    prototypes.add(*encoder->encode(frame), frame.context, PadState::incipient);
  }
}

BENCHMARK_CAPTURE(reference, paper, Compat::paper);
BENCHMARK_CAPTURE(reference, published_core, Compat::published_core);
BENCHMARK(quantised);
BENCHMARK(trained);

}  // namespace

void register_kernels() {
  const std::vector<std::string> names{"portable", "avx2", "avx512"};
  for (const KernelPath path : kernel_paths()) {
    for (const auto& [compat, compat_name] :
         {std::pair(Compat::paper, "paper"), std::pair(Compat::published_core, "published_core")}) {
      benchmark::RegisterBenchmark(("kernel/" + names[static_cast<std::size_t>(path)] + "/" + compat_name).c_str(), kernel, path,
                                   compat);
    }
  }
}

}  // namespace slipbench::hd

int main(int argc, char** argv) {
  slipbench::hd::register_kernels();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
