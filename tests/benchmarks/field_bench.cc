// Times one step of the element field: pads on a plane, sliding with rotation, everything in
// contact; with and without labels.
#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "tests/oracle/pads.h"

namespace slipbench {
namespace {

constexpr double dt = 1e-3;

// The pad turns and slides to and fro slowly enough to stay on its small circle, with some elements
// stuck and some slipping.
Pose pose_at(std::size_t tick) {
  const double phase = 1e-3 * static_cast<double>(tick % 6283);
  Pose pose;
  pose.rotation(0, 0) = pose.rotation(1, 1) = 1.0 - 0.5 * phase * phase * 1e-6;
  pose.position = {1e-3 * phase, 0.5e-3 * phase, -1e-3};
  return pose;
}

void steps(benchmark::State& state, const PadLayout& pad, bool labels) {
  Field field(pad, Plane{}, {0.5, 0.5});
  ContactLabels contact(field.layout());
  std::vector<Pose> poses;
  for (std::size_t tick = 0; tick < 4096; ++tick) poses.push_back(pose_at(tick));
  std::size_t tick = 0;
  for (auto _ : state) {
    field.step(poses[tick++ % poses.size()], dt);
    if (labels) benchmark::DoNotOptimize(contact.update({&field, 1}, dt, dt).force.data());
    benchmark::ClobberMemory();
  }
  state.counters["per_element"] = benchmark::Counter(static_cast<double>(field.size()),
                                                     benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void field_step_9(benchmark::State& state) { steps(state, oracle::nine_pillars(), false); }
void field_step_9_labelled(benchmark::State& state) { steps(state, oracle::nine_pillars(), true); }
void field_step_54(benchmark::State& state) { steps(state, oracle::nine_pillars(6), false); }
void field_step_54_labelled(benchmark::State& state) { steps(state, oracle::nine_pillars(6), true); }
void field_step_256(benchmark::State& state) { steps(state, oracle::square_grid(16, 0.08, 1000.0, 600.0), false); }
void field_step_1024(benchmark::State& state) { steps(state, oracle::square_grid(32, 0.08, 1000.0, 600.0), false); }

// 36 nibs at 2.4 kHz sliding at 2 mm/s, all slipping, with the named effects.
void nib_steps(benchmark::State& state, const std::vector<std::pair<std::string, std::map<std::string, double>>>& wanted) {
  const PadLayout pad = oracle::square_grid(6, 30e-3, 830.0, 200.0);
  std::vector<Named> effects;
  for (const auto& [name, changes] : wanted) {
    const auto kind = std::ranges::find(effect_catalogue(), name, [](const EffectKind& known) { return known.about.name; });
    Named& effect = effects.emplace_back(Named{name, defaults_of(kind->about.parameters)});
    for (const auto& [key, value] : changes) effect.parameters.set(key, value);
  }
  Field field(pad, Plane{}, {0.5, 0.5}, install_effects(effects, pad, Plane{}, 1, 0));
  constexpr double nib_dt = 1.0 / 2400.0;
  std::size_t tick = 0;
  Pose pose;
  for (auto _ : state) {
    pose.position = {2e-3 * nib_dt * static_cast<double>(tick++), 0.0, -0.5e-3};
    field.step(pose, nib_dt);
    benchmark::ClobberMemory();
  }
}

void nib_step(benchmark::State& state) { nib_steps(state, {}); }
void nib_step_patches(benchmark::State& state) { nib_steps(state, {{"patchy_friction", {}}}); }
void nib_step_rate(benchmark::State& state) { nib_steps(state, {{"viscous_friction", {{"gain", 0.08}, {"speed", 0.05e-3}}}}); }
void nib_step_rate_patches(benchmark::State& state) {
  nib_steps(state, {{"viscous_friction", {{"gain", 0.08}, {"speed", 0.05e-3}}}, {"patchy_friction", {}}});
}

BENCHMARK(nib_step);
BENCHMARK(nib_step_patches);
BENCHMARK(nib_step_rate);
BENCHMARK(nib_step_rate_patches);
BENCHMARK(field_step_9);
BENCHMARK(field_step_9_labelled);
BENCHMARK(field_step_54);
BENCHMARK(field_step_54_labelled);
BENCHMARK(field_step_256);
BENCHMARK(field_step_1024);

}  // namespace
}  // namespace slipbench

BENCHMARK_MAIN();
