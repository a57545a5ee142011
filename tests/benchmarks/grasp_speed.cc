// Times a trial of scenes/grasp/lift.yaml from the scene to the last tick: nine pillars and 24
// elements on a box of 0.2 kg, real stiffness, the sensor's 100 Hz, the step chosen by `auto`, and
// a loop that tightens to the preset force. No recorder, no detector. CPU time.
#include <string>

#include <benchmark/benchmark.h>

#include "tests/sim/mujoco/bodies/grasp_rig.h"

namespace slipbench {
namespace {

constexpr const char* felt =
    "effects: [{anisotropic_friction: {ratio: 0.6}}, {patchy_friction: {sd: 0.2, shortest: 8 mm, longest: 20 mm}}]\n";

void lift(benchmark::State& state, const std::string& material, const std::string& more) {
  double simulated = 0.0;
  std::uint64_t trial = 0;
  for (auto _ : state) {
    GraspRig rig("surface: {material: " + material + "}\ngrip: {}\nscatter: {}\n" + more, trial++, {}, ", rate: 100 Hz");
    rig.run();
    simulated += static_cast<double>(rig->ticks(0)) * rig->time_step(0);
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}

BENCHMARK_CAPTURE(lift, ptfe, "ptfe", "")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lift, rubber, "rubber", "")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lift, felt, "felt", felt)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(lift, viscous, "ptfe", "effects: [viscous_friction]\n")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
