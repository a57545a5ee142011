// Times mj_step with the plugin's pads: two of them hold a free box of 0.1 kg at 1 ms.
// `without_pads` is MuJoCo's own part: the same bodies without pads between them. The difference is
// the plugin's cost. CPU time, because it is less disturbed by other programs than wall time.
#include <string>

#include <benchmark/benchmark.h>

#include "tests/sim/mujoco/pads/plugin_rig.h"

namespace slipbench::testing_plugin {
namespace {

// n x n elements on 14 x 14 mm with the total stiffness of nine elements of 3 kN/m and 500 N/m.
std::string pad_of_side(int n) { return config("elements", square(n, 0.021 / n, 27000.0 / (n * n), 4500.0 / (n * n))); }

void step(benchmark::State& state, Grip grip, bool read) {
  std::string xml = grip_xml(grip);
  if (!read && !grip.left.empty()) xml.erase(xml.find("<sensor>"), xml.find("</sensor>") + 9 - xml.find("<sensor>"));
  const Model model = load(xml);
  const Data data = data_of(model);
  if (grip.left.empty()) model->opt.disableflags |= mjDSBL_CONTACT;
  data->ctrl[0] = grip.left.empty() ? 0.0 : 1.5;
  for (int i = 0; i < 500; ++i) mj_step(model.get(), data.get());  // closed
  if (!grip.left.empty()) model->opt.gravity[2] = -g;
  for (auto _ : state) mj_step(model.get(), data.get());
  if (data->qpos[2] < -0.01) state.SkipWithError("the box has dropped");
  const auto steps = static_cast<double>(state.iterations());
  state.counters["x_real_time"] = benchmark::Counter(grip.dt * steps, benchmark::Counter::kIsRate);
  if (!grip.left.empty()) {
    const auto elements = static_cast<double>(2 * pad_of(model.get(), data.get(), 0)->sensor().layout().elements.size());
    state.counters["per_element"] =
        benchmark::Counter(elements, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  }
}

void without_pads(benchmark::State& state) { step(state, {.left = "", .right = ""}, false); }
void two_pads_of_9(benchmark::State& state) { step(state, {.truth = false}, true); }
void two_pads_of_9_with_truth(benchmark::State& state) { step(state, {}, true); }
void two_pads_of_9_unread(benchmark::State& state) { step(state, {}, false); }
void two_pads_of_9_rk4(benchmark::State& state) { step(state, {.integrator = "RK4"}, true); }
void two_pads_of_256(benchmark::State& state) {
  step(state, {.left = pad_of_side(16), .right = pad_of_side(16), .truth = false}, true);
}
void two_pads_of_256_with_truth(benchmark::State& state) {
  step(state, {.left = pad_of_side(16), .right = pad_of_side(16)}, true);
}
void two_pads_of_256_unread(benchmark::State& state) { step(state, {.left = pad_of_side(16), .right = pad_of_side(16)}, false); }

BENCHMARK(without_pads);
BENCHMARK(two_pads_of_9);
BENCHMARK(two_pads_of_9_with_truth);
BENCHMARK(two_pads_of_9_unread);
BENCHMARK(two_pads_of_9_rk4);
BENCHMARK(two_pads_of_256);
BENCHMARK(two_pads_of_256_with_truth);
BENCHMARK(two_pads_of_256_unread);

}  // namespace
}  // namespace slipbench::testing_plugin

BENCHMARK_MAIN();
