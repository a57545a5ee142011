// What a trial of scenes/nib_pad/reorient.yaml costs, from the scene to the outcome: two pads of 36 nibs, the sensor read at 2,400 Hz, spectra,
// controller, and all that the outcome holds; nothing is written. CPU time.
#include <benchmark/benchmark.h>

#include "sim/scene/parser.h"
#include "tools/program/catalogue/program_catalogues.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {
namespace {

void reorient(benchmark::State& state) {
  const Catalogues catalogues = program_catalogues();
  const Scene scene = parse_scene(SceneFile::load(SLIPBENCH_SOURCE_DIR "/scenes/nib_pad/reorient.yaml"), catalogues);
  double simulated = 0.0;
  std::uint64_t trial = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(run_trial(scene, trial++, Recording::outcome).record.outcome.max_slip_distance);
    simulated += scene.duration;
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}

BENCHMARK(reorient)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
