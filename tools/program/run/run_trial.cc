#include "tools/program/run/run_trial.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/simulation/stage_simulation.h"
#include "tools/base/dataset/encoder.h"
#include "tools/program/catalogue/controller_catalogue.h"
#include "tools/program/catalogue/detector_catalogue.h"
#include "tools/program/catalogue/sensor_catalogue.h"
#include "tools/program/run/detector_loop.h"
#include "tools/program/run/grip_loop.h"
#include "tools/program/run/recorder.h"
#ifdef SLIPBENCH_WITH_MUJOCO
#include "sim/mujoco/articulated_simulation.h"
#include "sim/mujoco/dynamic_simulation.h"
#include "sim/mujoco/grasp_simulation.h"
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
std::unique_ptr<Simulation> make_mujoco_simulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                                   std::span<const double> rates, std::uint64_t trial) {
  if (!scene.dynamic()) return std::make_unique<ArticulatedSimulation>(scene, pads, rates, trial);
  [[maybe_unused]] static const bool registered = (register_field_plugin({pad_catalogues(), &make_sensor}), true);
  if (scene.grasp) return std::make_unique<GraspSimulation>(scene, pads, rates, trial);
  return std::make_unique<DynamicSimulation>(scene, pads, rates, trial);
}
#else
[[noreturn]] std::unique_ptr<Simulation> make_mujoco_simulation(const Scene& scene, std::span<const PadLayout* const>,
                                                                std::span<const double>, std::uint64_t) {
  const std::string key = !scene.dynamic() ? "fidelity" : scene.grasp ? "grip" : scene.model.empty() ? "bodies" : "model";
  throw SceneValueError(key, "needs MuJoCo, which this program was built without");
}
#endif

std::unique_ptr<Simulation> make_simulation(const Scene& scene, const Sensors& sensors, std::uint64_t trial) {
  std::vector<const PadLayout*> pads;
  std::vector<double> rates;
  for (const auto& sensor : sensors) {
    pads.push_back(&sensor->layout());
    rates.push_back(sensor->rate() * static_cast<double>(sensor->scans()));
  }
  if (scene.dynamic() || scene.fidelity != "field") return make_mujoco_simulation(scene, pads, rates, trial);
  return std::make_unique<StageSimulation>(scene, pads, rates, trial);
}

DetectorLoop make_loop(const DetectorScene& detector, const Scene& scene, const Sensors& sensors, const Simulation& simulation,
                       std::uint64_t trial) {
  const SensorScene& about = scene.sensors[detector.sensor];
  const Sensor& sensor = *sensors[detector.sensor];
  return {make_detector(detector, {about.name, about.type, sensor.rate(), sensor.channels(), trial, scene.duration, scene.seed},
                        simulation),
          detector.sensor};
}

GripLoop make_grip_loop(Simulation& simulation, const Scene& scene, const Sensors& sensors, std::uint64_t trial) {
  if (const double start = simulation.held_box()->lift_start(); !scene.guided() && scene.duration <= start) {
    throw SceneValueError("duration",
                          "ends before the box is lifted; allowed: more than " + format_quantity(start, Quantity::time));
  }
  std::optional<DetectorLoop> detector;
  if (scene.detector) detector = make_loop(*scene.detector, scene, sensors, simulation, trial);
  std::unique_ptr<Controller> controller;
  if (scene.controller) {
    controller = make_controller(*scene.controller, {.channels = sensors.front()->channels(),
                                                     .preset = scene.grasp->grip.number("preset"),
                                                     .detected = detector.has_value(),
                                                     .features = detector ? detector->features() : std::vector<Feature>{},
                                                     .guided = scene.guided()});
  }
  return {*simulation.held_box(), std::move(controller), std::move(detector)};
}

// How many ticks each pad has had.
using Ticks = std::vector<std::size_t>;

bool has_tick(const Simulation& simulation, std::size_t pad) {
  const std::span<const std::size_t> stepped = simulation.stepped();
  return std::ranges::find(stepped, pad) != stepped.end();
}

void close_loop(TrialRecorder&, const Ticks&, const Simulation&, const OpenLoop&) {}
void close_loop(TrialRecorder& recorder, const Ticks& had, const Simulation& simulation, DetectorLoop& loop) {
  if (!has_tick(simulation, loop.pad())) return;
  const ContactFrame& truth = simulation.contact(loop.pad());
  recorder.loop(had[loop.pad()] - 1, truth, loop.seen_at(truth.time).state);
}
void close_loop(TrialRecorder& recorder, const Ticks& had, Simulation& simulation, GripLoop& loop) {
  if (has_tick(simulation, 0)) {
    const ContactFrame& truth = simulation.contact(0);
    loop.act(truth.time);
    recorder.grip(truth, *simulation.held_box(), loop);
  }
  if (!loop.closed() || !has_tick(simulation, loop.pad())) return;
  const std::size_t tick = had[loop.pad()] - 1;
  recorder.grip_row(tick, *simulation.held_box(), loop);
  recorder.loop(tick, simulation.contact(loop.pad()), loop.seen());
}

template <class Loop>
void run(Simulation& simulation, const Sensors& sensors, TrialRecorder& recorder, Loop& loop) {
  Ticks had(sensors.size(), 0);
  std::size_t left = 0;
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) left += simulation.ticks(pad);
  while (left > 0) {
    simulation.step();
    const std::span<const std::size_t> stepped = simulation.stepped();
    for (const std::size_t pad : stepped) {
      const std::size_t tick = had[pad]++;
      const ContactFrame& truth = simulation.contact(pad);
      recorder.observe(pad, truth);
      recorder.bodies(pad, tick, truth.time, simulation.bodies());
      const Sampling& sampling = recorder.sampling(pad);
      if (!sampling.reads_at(tick)) continue;
      const SensorFrame& frame = sensors[pad]->measure(truth);
      if (!sampling.completes_at(tick)) continue;
      recorder.sample(pad, truth, frame);
      loop.sample(pad, frame);
    }
    close_loop(recorder, had, simulation, loop);
    left -= stepped.size();
  }
}

double shortest_step(const Simulation& simulation, std::size_t pads) {
  double shortest = simulation.time_step(0);
  for (std::size_t pad = 1; pad < pads; ++pad) shortest = std::min(shortest, simulation.time_step(pad));
  return shortest;
}

}  // namespace

double check_trial(const Scene& scene, std::uint64_t trial) {
  const Sensors sensors = make_sensors(scene, trial);
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, sensors, trial);
  if (simulation->held_box() != nullptr) {
    static_cast<void>(make_grip_loop(*simulation, scene, sensors, trial));
  } else if (scene.detector) {
    static_cast<void>(make_loop(*scene.detector, scene, sensors, *simulation, trial));
  }
  return record_bytes(scene, sensors, *simulation);
}

TrialResult run_trial(const Scene& scene, std::uint64_t trial, Recording recording, double max_bytes) {
  const Sensors sensors = make_sensors(scene, trial);
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, sensors, trial);
  TrialRecorder recorder(scene, sensors, *simulation, trial, recording, max_bytes);
  if (simulation->held_box() != nullptr) {
    GripLoop loop = make_grip_loop(*simulation, scene, sensors, trial);
    run(*simulation, sensors, recorder, loop);
  } else if (scene.detector) {
    DetectorLoop loop = make_loop(*scene.detector, scene, sensors, *simulation, trial);
    run(*simulation, sensors, recorder, loop);
  } else {
    OpenLoop loop;
    run(*simulation, sensors, recorder, loop);
  }
  TrialResult result = recorder.finish();
  result.time_step = shortest_step(*simulation, sensors.size());
  if (!scene.model.empty()) result.record.model_sha256 = file_sha256(scene.model);
  return result;
}

}  // namespace slipbench
