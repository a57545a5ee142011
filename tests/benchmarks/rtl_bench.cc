// Times one sample through the whole Verilated core. Run with --benchmark_repetitions=9 and read
// the medians.
#include <benchmark/benchmark.h>

#include "rtl/verilated/rtl_engine.h"
#include "tests/detectors/hd/random_frames.h"

namespace slipbench::hd {
namespace {

constexpr std::uint64_t seed = 1;

void update(benchmark::State& state, Unrolling unrolling) {
  const Model model;
  const auto engine = make_rtl_engine(model, random_memories(model, seed), {.unrolling = unrolling});
  std::int16_t step = 0;
  for (auto _ : state) {
    FixedFrame sample;
    for (FixedVector& displacement : sample) displacement = {step = static_cast<std::int16_t>((step + 7) % 31), 3, 9};
    benchmark::DoNotOptimize(engine->update(sample));
  }
  state.counters["cycles"] = engine->cycles();
}

BENCHMARK_CAPTURE(update, fastest, Unrolling::fastest);
BENCHMARK_CAPTURE(update, middle, Unrolling::middle);
BENCHMARK_CAPTURE(update, smallest, Unrolling::smallest);

}  // namespace
}  // namespace slipbench::hd

BENCHMARK_MAIN();
