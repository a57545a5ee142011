#include "tools/run/run_trial.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/testbench/testbench.h"
#include "tools/catalogue/controllers.h"
#include "tools/catalogue/detectors.h"
#include "tools/catalogue/sensors.h"
#include "tools/dataset/encoder.h"
#include "tools/run/detector_loop.h"
#include "tools/run/grip_loop.h"
#include "tools/run/recorder.h"
#ifdef SLIPBENCH_WITH_MUJOCO
#include "sim/mujoco/articulated_testbench.h"
#include "sim/mujoco/dynamic_bench.h"
#include "sim/mujoco/grasp_bench.h"
#include "sim/mujoco/register_plugin.h"
#endif

namespace slipbench {

namespace {

using Sensors = std::vector<std::unique_ptr<Sensor>>;

Sensors make_sensors(const Scene& scene, std::uint64_t trial) {
  Sensors sensors;
  for (const SensorScene& description : scene.sensors) sensors.push_back(make_sensor(description, scene.seed, trial));
  return sensors;
}

#ifdef SLIPBENCH_WITH_MUJOCO
std::unique_ptr<Bench> make_mujoco_bench(const Scene& scene, std::span<const PadLayout* const> pads,
                                         std::span<const double> rates, std::uint64_t trial) {
  if (!scene.dynamic()) return std::make_unique<ArticulatedTestbench>(scene, pads, rates, trial);
  [[maybe_unused]] static const bool registered = (register_field_plugin({pad_catalogues(), &make_sensor}), true);
  if (scene.grasp) return std::make_unique<GraspBench>(scene, pads, rates, trial);
  return std::make_unique<DynamicBench>(scene, pads, rates, trial);
}
#else
[[noreturn]] std::unique_ptr<Bench> make_mujoco_bench(const Scene& scene, std::span<const PadLayout* const>,
                                                      std::span<const double>, std::uint64_t) {
  const std::string key = !scene.dynamic() ? "fidelity" : scene.grasp ? "grip" : scene.model.empty() ? "bodies" : "model";
  throw SceneValueError(key, "needs MuJoCo, which this program was built without");
}
#endif

std::unique_ptr<Bench> make_bench(const Scene& scene, const Sensors& sensors, std::uint64_t trial) {
  std::vector<const PadLayout*> pads;
  std::vector<double> rates;
  for (const auto& sensor : sensors) {
    pads.push_back(&sensor->layout());
    rates.push_back(sensor->rate() * static_cast<double>(sensor->scans()));
  }
  if (scene.dynamic() || scene.fidelity != "field") return make_mujoco_bench(scene, pads, rates, trial);
  return std::make_unique<Testbench>(scene, pads, rates, trial);
}

DetectorLoop make_loop(const DetectorScene& detector, const Scene& scene, const Sensors& sensors, const Bench& bench,
                       std::uint64_t trial) {
  const SensorScene& about = scene.sensors[detector.sensor];
  const Sensor& sensor = *sensors[detector.sensor];
  return {make_detector(detector, {about.name, about.type, sensor.rate(), sensor.channels(), trial, scene.duration, scene.seed},
                        bench),
          detector.sensor};
}

GripLoop make_grip_loop(Bench& bench, const Scene& scene, const Sensors& sensors, std::uint64_t trial) {
  if (const double start = bench.held_box()->lift_start(); !scene.guided() && scene.duration <= start) {
    throw SceneValueError("duration",
                          "ends before the box is lifted; allowed: more than " + format_quantity(start, Quantity::time));
  }
  std::optional<DetectorLoop> detector;
  if (scene.detector) detector = make_loop(*scene.detector, scene, sensors, bench, trial);
  std::unique_ptr<Controller> controller;
  if (scene.controller) {
    controller = make_controller(*scene.controller, {.channels = sensors.front()->channels(),
                                                     .preset = scene.grasp->grip.number("preset"),
                                                     .detected = detector.has_value(),
                                                     .features = detector ? detector->features() : std::vector<Feature>{},
                                                     .guided = scene.guided()});
  }
  return {*bench.held_box(), std::move(controller), std::move(detector)};
}

// How many ticks each pad has had.
using Ticks = std::vector<std::size_t>;

bool has_tick(const Bench& bench, std::size_t pad) {
  const std::span<const std::size_t> stepped = bench.stepped();
  return std::ranges::find(stepped, pad) != stepped.end();
}

void close_loop(TrialRecorder&, const Ticks&, const Bench&, const OpenLoop&) {}
void close_loop(TrialRecorder& recorder, const Ticks& had, const Bench& bench, DetectorLoop& loop) {
  if (!has_tick(bench, loop.pad())) return;
  const ContactFrame& truth = bench.contact(loop.pad());
  recorder.loop(had[loop.pad()] - 1, truth, loop.seen_at(truth.time).state);
}
void close_loop(TrialRecorder& recorder, const Ticks& had, Bench& bench, GripLoop& loop) {
  if (has_tick(bench, 0)) {
    const ContactFrame& truth = bench.contact(0);
    loop.act(truth.time);
    recorder.grip(truth, *bench.held_box(), loop);
  }
  if (!loop.closed() || !has_tick(bench, loop.pad())) return;
  const std::size_t tick = had[loop.pad()] - 1;
  recorder.grip_row(tick, *bench.held_box(), loop);
  recorder.loop(tick, bench.contact(loop.pad()), loop.seen());
}

template <class Loop>
void run(Bench& bench, const Sensors& sensors, TrialRecorder& recorder, Loop& loop) {
  Ticks had(sensors.size(), 0);
  std::size_t left = 0;
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) left += bench.ticks(pad);
  while (left > 0) {
    bench.step();
    const std::span<const std::size_t> stepped = bench.stepped();
    for (const std::size_t pad : stepped) {
      const std::size_t tick = had[pad]++;
      const ContactFrame& truth = bench.contact(pad);
      recorder.observe(pad, truth);
      recorder.bodies(pad, tick, truth.time, bench.bodies());
      const Sampling& sampling = recorder.sampling(pad);
      if (!sampling.reads_at(tick)) continue;
      const SensorFrame& frame = sensors[pad]->measure(truth);
      if (!sampling.completes_at(tick)) continue;
      recorder.sample(pad, truth, frame);
      loop.sample(pad, frame);
    }
    close_loop(recorder, had, bench, loop);
    left -= stepped.size();
  }
}

double shortest_step(const Bench& bench, std::size_t pads) {
  double shortest = bench.time_step(0);
  for (std::size_t pad = 1; pad < pads; ++pad) shortest = std::min(shortest, bench.time_step(pad));
  return shortest;
}

}  // namespace

double check_trial(const Scene& scene, std::uint64_t trial) {
  const Sensors sensors = make_sensors(scene, trial);
  const std::unique_ptr<Bench> bench = make_bench(scene, sensors, trial);
  if (bench->held_box() != nullptr) {
    static_cast<void>(make_grip_loop(*bench, scene, sensors, trial));
  } else if (scene.detector) {
    static_cast<void>(make_loop(*scene.detector, scene, sensors, *bench, trial));
  }
  return record_bytes(scene, sensors, *bench);
}

TrialResult run_trial(const Scene& scene, std::uint64_t trial, Recording recording, double max_bytes) {
  const Sensors sensors = make_sensors(scene, trial);
  const std::unique_ptr<Bench> bench = make_bench(scene, sensors, trial);
  TrialRecorder recorder(scene, sensors, *bench, trial, recording, max_bytes);
  if (bench->held_box() != nullptr) {
    GripLoop loop = make_grip_loop(*bench, scene, sensors, trial);
    run(*bench, sensors, recorder, loop);
  } else if (scene.detector) {
    DetectorLoop loop = make_loop(*scene.detector, scene, sensors, *bench, trial);
    run(*bench, sensors, recorder, loop);
  } else {
    OpenLoop loop;
    run(*bench, sensors, recorder, loop);
  }
  TrialResult result = recorder.finish();
  result.time_step = shortest_step(*bench, sensors.size());
  if (!scene.model.empty()) result.record.model_sha256 = file_sha256(scene.model);
  return result;
}

}  // namespace slipbench
