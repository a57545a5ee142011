// Times a cycle of a BioTac SP (1,000 per second) and a step of its skin on each surface. Run with
// --benchmark_repetitions=9 and read the medians.
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "tests/sensors/biotac_sp/rig.h"

namespace slipbench::biotac_sp_test {
namespace {

std::unique_ptr<Sensor> finger(const std::string& scan, std::int64_t elements, const std::vector<std::string>& electronics) {
  return make({{"scan", scan}, {"elements", elements}}, electronics);
}

// The skin on a surface, 1.6 mm deep and rocking, as in scenes.
template <class Shape>
void step(benchmark::State& state, const Shape& surface, double top, bool labelled, bool read) {
  const auto sensor = finger("device", state.range(0), {"typical"});
  Field field(sensor->layout(), surface, {0.5, 0.4});
  ContactLabels labels(sensor->layout());
  const double dt = 1e-3;
  double tick = 0.0;
  for (auto _ : state) {
    Pose pose = pressed({0.2 * std::sin(0.001 * tick), 0.0, -1.0}, 1.6e-3, radii);
    pose.position.z() += top;
    tick += 1.0;
    field.step(pose, dt);
    if (labelled) labels.update({&field, 1}, tick * dt, dt);
    if (read) benchmark::DoNotOptimize(sensor->measure(labels.frame()).values.data());
    benchmark::ClobberMemory();
  }
}

const Cylinder lying{30e-3, 50e-3};

void field_on_plane(benchmark::State& state) { step(state, Plane{}, 0.0, false, false); }
void field_on_box(benchmark::State& state) { step(state, Box{{30e-3, 30e-3, 20e-3}}, 20e-3, false, false); }
void field_on_cylinder(benchmark::State& state) { step(state, lying, 50e-3, false, false); }
void field_on_sphere(benchmark::State& state) { step(state, Sphere{30e-3}, 30e-3, false, false); }
void labelled_on_plane(benchmark::State& state) { step(state, Plane{}, 0.0, true, false); }
void all_on_plane(benchmark::State& state) { step(state, Plane{}, 0.0, true, true); }
void all_on_box(benchmark::State& state) { step(state, Box{{30e-3, 30e-3, 20e-3}}, 20e-3, true, true); }
BENCHMARK(field_on_plane)->Arg(300)->Arg(600)->Arg(1200);
BENCHMARK(field_on_box)->Arg(300)->Arg(600);
BENCHMARK(field_on_cylinder)->Arg(300)->Arg(600);
BENCHMARK(field_on_sphere)->Arg(300)->Arg(600);
BENCHMARK(labelled_on_plane)->Arg(300)->Arg(600)->Arg(1200);
BENCHMARK(all_on_plane)->Arg(300)->Arg(600)->Arg(1200);
BENCHMARK(all_on_box)->Arg(300)->Arg(600);

// One cycle: two electrodes with the device's scan, all 24 with `all`, so that the difference is
// the time of unscheduled ones.
void reading(benchmark::State& state, const std::string& scan, double cycle_rate, const std::vector<std::string>& electronics) {
  const auto sensor = make({{"scan", scan}, {"cycle_rate", cycle_rate}}, electronics);
  Field field(sensor->layout(), Plane{}, {0.5, 0.4});
  ContactLabels labels(sensor->layout());
  field.step(pressed({0.1, 0.0, -1.0}, 1.6e-3, radii), 1e-3);
  const ContactFrame& truth = labels.update({&field, 1}, 0.0, 1e-3);
  for (auto _ : state) benchmark::DoNotOptimize(sensor->measure(truth).values.data());
}
BENCHMARK_CAPTURE(reading, scheduled_ideal, "device", 1000.0, {});
BENCHMARK_CAPTURE(reading, scheduled_typical, "device", 1000.0, {"typical"});
BENCHMARK_CAPTURE(reading, all_electrodes_ideal, "ideal", 100.0, {});

}  // namespace
}  // namespace slipbench::biotac_sp_test

BENCHMARK_MAIN();
