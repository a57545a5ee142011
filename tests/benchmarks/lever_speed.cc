// What a trial on the lever bench costs, from the scene to the last tick at 2400 Hz: 36 nibs on a plate that forces move, sensor with noise and
// drift, and the detector; nothing is recorded but the outcome. Of each scene the first trial of its sweep, and that of a wavy plate. CPU time.
#include <cstddef>
#include <string>

#include "sim/scene/parser.h"
#include "tests/benchmarks/trials.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench {
namespace {

void lever(benchmark::State& state, const std::string& name, std::size_t cell) {
  const Catalogues catalogues = program_catalogues();
  const TrialPlan plan(SceneFile::load(SLIPBENCH_SOURCE_DIR "/scenes/nib_pad/" + name), catalogues, 1, 1);
  const Scene scene = plan.trial(cell).scene;
  time_trials(state, scene, [cell](std::size_t) { return cell; });
}

BENCHMARK_CAPTURE(lever, release_paper, "release.yaml", 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lever, release_wavy, "release.yaml", 10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lever, linear_paper, "linear.yaml", 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lever, rotational_paper, "rotational.yaml", 0)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
