// Times a step of 0.1 ms of a patch with friction vibration: 20 elements, one unit, sliding at 10
// mm/s; by effects, and with labels.
#include <algorithm>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "sim/api/motion.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/stage/stage_simulation.h"

namespace slipbench {
namespace {

constexpr double dt = 1e-4, speed = 10e-3, depth = 2e-3, force = 5.0;
constexpr int elements = 20;

// A patch of 8 x 10 mm whose elements share 5 N evenly and 6 N/mm tangentially.
PadLayout patch() {
  PadLayout pad;
  for (int i = 0; i < elements; ++i) {
    pad.elements.push_back({.tip = {2e-3 * (i % 5 - 2), 2e-3 * (i / 5), 1e-5 * i},
                            .k_normal = force / depth / elements,
                            .k_tangential = 6e3 / elements});
  }
  pad.units.push_back({0, elements});
  return pad;
}

std::vector<Named> named(const std::vector<std::string>& names) {
  std::vector<Named> effects;
  for (const std::string& name : names) {
    const auto kind = std::ranges::find(effect_catalogue(), name, [](const EffectKind& known) { return known.about.name; });
    effects.push_back({name, defaults_of(kind->about.parameters)});
  }
  return effects;
}

void steps(benchmark::State& state, const std::vector<std::string>& names, bool labelled) {
  const PadLayout pad = patch();
  Field field(pad, Plane{}, {0.7, 0.58}, install_effects(named(names), pad, Plane{}, 1, 0));
  ContactLabels labels(pad);
  double tick = 0.0, changes = 0.0;
  for (auto _ : state) {
    Pose pose;
    pose.position = {speed * dt * tick, 0.0, -depth};
    tick += 1.0;
    field.step(pose, dt);
    if (labelled) benchmark::DoNotOptimize(labels.update({&field, 1}, tick * dt, dt).force.data());
    benchmark::ClobberMemory();
    changes += static_cast<double>(field.events().size());
  }
  state.counters["changes_per_step"] = changes / tick;
}

void massless(benchmark::State& state) { steps(state, {}, false); }
void massless_labelled(benchmark::State& state) { steps(state, {}, true); }
void inertia(benchmark::State& state) { steps(state, {"inertia"}, false); }
void inertia_labelled(benchmark::State& state) { steps(state, {"inertia"}, true); }
void roughness(benchmark::State& state) { steps(state, {"inertia", "roughness"}, false); }
void asperities(benchmark::State& state) { steps(state, {"inertia", "asperities"}, false); }
void everything(benchmark::State& state) { steps(state, {"inertia", "roughness", "asperities"}, false); }
void everything_labelled(benchmark::State& state) { steps(state, {"inertia", "roughness", "asperities"}, true); }
// The whole bench of a scene, without a sensor.
void whole_bench(benchmark::State& state, const std::vector<std::string>& names) {
  Scene scene;
  scene.duration = 3600.0;
  scene.time_step = dt;
  scene.friction = {0.7, 0.58};
  scene.surface.name = "plane";
  scene.motion = {"stage", defaults_of(motion_catalogue().front().about.parameters)};
  scene.motion.parameters.set("compression", depth);
  scene.motion.parameters.set("speed", speed);
  scene.effects = named(names);
  scene.sensors.emplace_back();
  const PadLayout pad = patch();
  const PadLayout* const pads[] = {&pad};
  const double rates[] = {1.0 / dt};
  StageSimulation bench(scene, pads, rates, 0);
  for (int tick = 0; tick < 30000; ++tick) bench.step();  // slides from 2 s on
  for (auto _ : state) {
    bench.step();
    benchmark::DoNotOptimize(bench.contact(0).force.data());
  }
}
void bench_massless(benchmark::State& state) { whole_bench(state, {}); }
void bench_everything(benchmark::State& state) { whole_bench(state, {"inertia", "roughness", "asperities"}); }

BENCHMARK(massless);
BENCHMARK(massless_labelled);
BENCHMARK(inertia);
BENCHMARK(inertia_labelled);
BENCHMARK(roughness);
BENCHMARK(asperities);
BENCHMARK(everything);
BENCHMARK(everything_labelled);
BENCHMARK(bench_massless);
BENCHMARK(bench_everything);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
