// What a trial of scenes/nib_pad/reorient.yaml costs, from the scene to the outcome: two pads of 36 nibs, the sensor read at 2,400 Hz, spectra,
// controller, and all that the outcome holds; nothing is written. CPU time.
#include "sim/scene/parser.h"
#include "tests/benchmarks/trials.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench {
namespace {

void reorient(benchmark::State& state) {
  const Catalogues catalogues = program_catalogues();
  const Scene scene = parse_scene(SceneFile::load(SLIPBENCH_SOURCE_DIR "/scenes/nib_pad/reorient.yaml"), catalogues);
  time_trials(state, scene, [](std::size_t k) { return k; });
}

BENCHMARK(reorient)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
