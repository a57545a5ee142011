// What several sensors on one contact cost against each of them alone: on a stage, and following the pad of a grasp. CPU time.
#include <string>
#include <vector>

#include "sim/scene/parser.h"
#include "tests/benchmarks/trials.h"
#include "tools/program/catalogue/program_catalogues.h"

namespace slipbench {
namespace {

void trials(benchmark::State& state, const std::string& file, const std::vector<Override>& changes) {
  SceneFile scene_file = SceneFile::load(SLIPBENCH_SOURCE_DIR "/scenes/" + file);
  for (const Override& change : changes) scene_file.apply(change);
  const Scene scene = parse_scene(scene_file, program_catalogues());
  time_trials(state, scene, [](std::size_t k) { return k; });
}

// Ten seconds of the slide over the skin, without its detector.
void stage(benchmark::State& state, const std::string& sensors) {
  trials(state, "piezo_skin/slide.yaml",
         {{"detector", "{type: none}"}, {"duration", "10 s"}, {"motion.travel", "1 m"}, {"sensors", sensors}});
}
BENCHMARK_CAPTURE(stage, skin, "{skin: {type: piezo_skin, electronics: typical}}")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(stage, pillars, "{pad: {type: papillarray, electronics: typical}}")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(stage, both, "{skin: {type: piezo_skin, electronics: typical}, pad: {type: papillarray, electronics: typical}}")
    ->Unit(benchmark::kMillisecond);

void grasp(benchmark::State& state, const std::string& followers) {
  trials(state, "grasp/two_skins.yaml", {{"sensors", "{pad: {type: papillarray, rate: 1 kHz}" + followers + "}"}});
}
BENCHMARK_CAPTURE(grasp, pillars, "")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(grasp, and_skin, ", skin: {type: piezo_skin, follows: pad}")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(grasp, and_skin_and_nib, ", skin: {type: piezo_skin, follows: pad}, nib: {type: nib_pad, follows: pad}")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
