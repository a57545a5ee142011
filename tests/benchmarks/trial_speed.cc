// Times whole trials of shipped scenes, from the scene to the outcome; nothing is written. CPU
// time.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/scenes.h"
#include "tools/trial/run_trial.h"

namespace slipbench {
namespace {

// Successive trials of a cell of the scene's sweep.
void trials(benchmark::State& state, const std::string& file, const std::vector<Override>& changes, std::size_t cell = 0) {
  const Scene scene = TrialPlan(shipped(file, changes), catalogues(), 1, 1).trial(cell).scene;
  double simulated = 0.0;
  for (std::size_t k = cell; auto _ : state) {
    benchmark::DoNotOptimize(run_trial(scene, k++, Recording::outcome).record.outcome.touch_time);
    simulated += scene.duration;
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}

// The lever bench: 36 nibs on a plate moved by forces, read at 2400 Hz, with a detector. The first
// trial, and one with a wavy plate.
void lever(benchmark::State& state, const std::string& name, std::size_t cell) { trials(state, "nib_pad/" + name, {}, cell); }
BENCHMARK_CAPTURE(lever, release_paper, "release.yaml", 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lever, release_wavy, "release.yaml", 10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lever, linear_paper, "linear.yaml", 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lever, rotational_paper, "rotational.yaml", 0)->Unit(benchmark::kMillisecond);

// Two pads of 36 nibs, the sensor read at 2400 Hz, spectra and controller.
void reorient(benchmark::State& state) { trials(state, "nib_pad/reorient.yaml", {}); }
BENCHMARK(reorient)->Unit(benchmark::kMillisecond);

// Ten seconds over the piezoelectric skin at 10 kHz, 9 of them in motion: whole, with one thing
// left out at a time, and with several sensors compared with each alone.
void slide(benchmark::State& state, std::vector<Override> changes) {
  changes.insert(changes.end(), {{"duration", "10 s"}, {"motion.travel", "1 m"}});
  trials(state, "piezo_skin/slide.yaml", changes);
}
BENCHMARK_CAPTURE(slide, whole, {})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(slide, no_detector, {{"detector", "{type: none}"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(slide, no_motors, {{"motion.vibration", "0"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(slide, ideal, {{"sensors.pad.electronics", "ideal"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(slide, no_effects, {{"effects", "[]"}})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(slide, motors_only, {{"motion.clearance", "5 mm"}})->Unit(benchmark::kMillisecond);
void sensors(benchmark::State& state, const std::string& which) {
  slide(state, {{"detector", "{type: none}"}, {"sensors", "{" + which + "}"}});
}
BENCHMARK_CAPTURE(sensors, skin, "skin: {type: piezo_skin, electronics: typical}")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sensors, pillars, "pad: {type: papillarray, electronics: typical}")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(sensors, both, "skin: {type: piezo_skin, electronics: typical}, pad: {type: papillarray, electronics: typical}")
    ->Unit(benchmark::kMillisecond);

// Sensors that follow the pad of a grasp.
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
