// Times one image of a Myrmex array of 256 taxels, with and without its electronics. Also times the
// whole bench where two arrays hold an object and a third of 12 taxels touches it: a trial of
// scenes/myrmex/dataset.yaml, from the scene to the last tick at 1 kHz, with all three read and
// only the outcome recorded. Run with --benchmark_repetitions=9 and read the medians of CPU time.
#include <cstddef>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/scenes.h"
#include "tests/sensors/myrmex/rig.h"
#include "tools/trial/run_trial.h"

namespace slipbench::myrmex_test {
namespace {

void image(benchmark::State& state, const std::vector<std::string>& names) {
  std::vector<Named> parts;
  for (const std::string& name : names) parts.push_back(part(name));
  const auto sensor = array({}, parts);
  ContactFrame truth = pressed(256, 10.0);
  for (auto _ : state) {
    truth.force(2, 0) += 1e-9;
    benchmark::DoNotOptimize(sensor->measure(truth).values.data());
  }
}

void trial(benchmark::State& state, std::size_t cell, bool typical) {
  Scene scene = TrialPlan(shipped("myrmex/dataset.yaml"), catalogues(), 1, 1).trial(cell).scene;
  for (SensorScene& sensor : scene.sensors) {
    if (!typical) sensor.electronics.clear();
  }
  double simulated = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(run_trial(scene, cell, Recording::outcome));
    simulated += scene.duration;
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(image, ideal, {});
BENCHMARK_CAPTURE(image, quantisation, {"quantisation"});
BENCHMARK_CAPTURE(image, scan_quantisation, {"scan", "quantisation"});
BENCHMARK_CAPTURE(image, typical, {"scan", "white_noise", "quantisation"});
BENCHMARK_CAPTURE(trial, cylinder_translation_ideal, 0, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trial, cylinder_translation, 0, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trial, box_translation_ideal, 2, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trial, box_rotation_ideal, 6, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(trial, glass_rotation_ideal, 7, false)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench::myrmex_test

BENCHMARK_MAIN();
