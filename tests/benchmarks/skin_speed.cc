// What a recording of scenes/piezo_skin/slide.yaml costs at 10 kHz, everything included: field, labels, sensor with typical electronics, motors,
// recorder of outcomes; with one thing left out at a time. CPU time.
#include <vector>

#include "sim/scene/parser.h"
#include "tests/benchmarks/trials.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench {
namespace {

void recording(benchmark::State& state, const std::vector<Override>& overrides) {
  SceneFile file = SceneFile::load(SLIPBENCH_SOURCE_DIR "/scenes/piezo_skin/slide.yaml");
  file.apply({"duration", "10 s"});  // of which 9 in motion
  file.apply({"motion.travel", "1 m"});
  for (const Override& change : overrides) file.apply(change);
  const Scene scene = parse_scene(file, program_catalogues());
  time_trials(state, scene, [](std::size_t k) { return k; });
}

BENCHMARK_CAPTURE(recording, slide, {})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(recording, no_detector, {{"detector", "{type: none}"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(recording, no_motors, {{"motion.vibration", "0"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(recording, ideal, {{"sensors.pad.electronics", "ideal"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(recording, no_effects, {{"effects", "[]"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(recording, motors_only, {{"motion.clearance", "5 mm"}})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
