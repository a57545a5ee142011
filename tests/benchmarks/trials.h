// Trials of a scene one after the other, under the clock.
#pragma once

#include <benchmark/benchmark.h>

#include "tools/program/run/run_trial.h"

namespace slipbench {

// `next(k)`: the number of the k-th trial.
template <class Next>
void time_trials(benchmark::State& state, const Scene& scene, const Next& next) {
  double simulated = 0.0;
  for (std::size_t k = 0; auto _ : state) {
    benchmark::DoNotOptimize(run_trial(scene, next(k++), Recording::outcome).record.outcome.touch_time);
    simulated += scene.duration;
  }
  state.counters["x_real_time"] = benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}

}  // namespace slipbench
