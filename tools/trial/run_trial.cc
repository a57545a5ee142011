#include "tools/trial/run_trial.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/quantity.h"
#include "sim/stage/stage_simulation.h"
#include "tools/dataset/record/encoder.h"
#include "tools/registry/sensor_catalogue.h"
#include "tools/trial/libraries.h"
#include "tools/trial/mujoco/mujoco_simulation.h"
#include "tools/trial/recorded_scene.h"
#include "tools/trial/trial_run.h"

namespace slipbench {
namespace {

using Sensors = std::vector<std::unique_ptr<Sensor>>;

Sensors make_sensors(const Scene& scene, std::uint64_t trial) {
  Sensors sensors;
  for (const SensorScene& description : scene.sensors) sensors.push_back(make_sensor(description, scene.seed, trial));
  return sensors;
}

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

std::vector<SensorSource> sources_of(const Scene& scene, const Sensors& sensors) {
  std::vector<SensorSource> sources;
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    sources.push_back({scene.sensors[i].name, scene.sensors[i].type, sensors[i]->rate(), sensors[i]->channels()});
  }
  return sources;
}

DelayedDetector make_delayed_detector(const DetectorScene& detector, const Scene& scene, const Sensors& sensors,
                                      const Simulation& simulation, std::uint64_t trial) {
  const SensorScene& about = scene.sensors[detector.sensor];
  const Sensor& sensor = *sensors[detector.sensor];
  return DelayedDetector(make_detector(
      detector,
      {about.name, about.type, sensor.rate(), sensor.channels(), trial, scene.duration, scene.seed, sources_of(scene, sensors)},
      simulation));
}

ControlLoop make_loop(const Scene& scene, const Sensors& sensors, Simulation& simulation, std::uint64_t trial,
                      TrialRun::Replacements replacements = {}) {
  auto* box = dynamic_cast<HeldBox*>(&simulation);
  if (box != nullptr && !scene.guided() && scene.duration <= box->lift_start()) {
    throw SceneValueError(
        "duration", "ends before the box is lifted; allowed: more than " + format_quantity(box->lift_start(), Quantity::time));
  }
  std::optional<DelayedDetector> detector;
  if (replacements.detector)
    detector.emplace(std::move(replacements.detector));
  else if (scene.detector)
    detector = make_delayed_detector(*scene.detector, scene, sensors, simulation, trial);
  std::unique_ptr<Controller> controller;
  if (scene.controller || replacements.controller) {
    const GripSource source{.channels = sensors.front()->channels(),
                            .preset = scene.grasp->grip.number("preset"),
                            .detected = detector.has_value(),
                            .features = detector ? detector->features() : std::vector<Feature>{},
                            .guided = scene.guided(),
                            .sensors = sources_of(scene, sensors)};
    controller = replacements.controller ? replacements.controller(source) : make_controller(*scene.controller, source);
  }
  const Answers answers = scene.controller && !replacements.controller ? answers_of(*scene.controller) : Answers::by_own_rule;
  return ControlLoop(std::move(detector), scene.detector ? scene.detector->sensor : 0, std::move(controller), box, answers);
}

// Checks the last tick, the only data of a trial without recording.
void check_last_tick(const TrialRecord& record, const Sensors& sensors, const Simulation& simulation, const Sampler& sampler) {
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    const std::string& name = record.sensors[pad].name;
    check_finite(name, simulation.contact(pad));
    check_finite(name, sensors[pad]->channels(), sampler.latest(pad));
  }
  check_finite(simulation.contact(0).time, simulation.bodies());
}

// Least duration of a step [s]: of a pad as a field on a stage, of bodies with fields, of
// articulated pads.
constexpr double field_step = 0.3e-6, body_step = 5e-6, pillar_step = 20e-6;

// Steps between checks for an interrupt: a check costs more than the rest of this loop, and 16
// steps take at most some ms.
constexpr std::size_t steps_between_looks = 16;

double shortest_step(const Simulation& simulation, std::size_t pads) {
  double shortest = simulation.time_step(0);
  for (std::size_t pad = 1; pad < pads; ++pad) shortest = std::min(shortest, simulation.time_step(pad));
  return shortest;
}

}  // namespace

double check_trial(const Scene& scene, std::uint64_t trial) {
  const Sensors sensors = make_sensors(scene, trial);
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, sensors, trial);
  const Sampler sampler(scene, sensors, *simulation);
  make_loop(scene, sensors, *simulation, trial).finish();
  static_cast<void>(split_group(scene));
  static_cast<void>(hold_bodies(scene, *simulation));
  return record_bytes(scene, sensors, *simulation, sampler);
}

PlannedSteps planned_steps(const Scene& scene, std::uint64_t trial) {
  const Sensors sensors = make_sensors(scene, trial);
  const std::unique_ptr<Simulation> simulation = make_simulation(scene, sensors, trial);
  const bool alone = !scene.dynamic();  // each pad has its own step
  PlannedSteps steps{.shortest = shortest_step(*simulation, sensors.size())};
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    const auto ticks = static_cast<double>(simulation->ticks(pad));
    steps.count = alone ? steps.count + ticks : std::max(steps.count, ticks);
  }
  const double each = scene.fidelity != "field" ? pillar_step : alone ? field_step : body_step;
  steps.seconds = steps.count * each;
  return steps;
}

TrialRun::TrialRun(Scene scene, std::uint64_t trial, Recording recording, double max_bytes, const std::atomic<bool>* interrupt,
                   Replacements replacements, std::atomic<double>* share)
    : scene_(std::move(scene)),
      sensors_(make_sensors(scene_, trial)),
      simulation_(make_simulation(scene_, sensors_, trial)),
      result_{.record = new_record(scene_, sensors_, *simulation_, trial), .units = {}},
      sampler_(scene_, sensors_, *simulation_),
      judge_(scene_, *simulation_, box(), result_),
      interrupt_(interrupt),
      share_(share) {
  if (recording == Recording::full) {
    recorder_.emplace(scene_, sensors_, *simulation_, box(), sampler_, max_bytes, result_.record);
  } else {
    simulation_->disable_slip_angle();
  }
  loop_ = make_loop(scene_, sensors_, *simulation_, trial, std::move(replacements));
}

// These three are the inner loop: a call of each costs one percent of a cheap scene's instructions.
[[gnu::always_inline]] inline std::span<const Tick> TrialRun::advance() {
  if (steps_++ % steps_between_looks == 0) {
    end_if(interrupt_);
    if (share_ != nullptr) {
      const double time = simulation_->contact_part(0, FramePart::states).time;
      share_->store(time / scene_.duration, std::memory_order_relaxed);
    }
  }
  simulation_->step();
  const std::span<const Tick> ticks = sampler_.measure();
  loop_.update(ticks);
  return ticks;
}

[[gnu::always_inline]] inline void TrialRun::observe(std::span<const Tick> ticks) {
  judge_.observe(ticks, loop_);
  if (recorder_) recorder_->record(ticks, loop_);
}

[[gnu::always_inline]] inline std::span<const Tick> TrialRun::next() {
  const std::span<const Tick> ticks = advance();
  loop_.act(ticks);
  observe(ticks);
  return ticks;
}

std::span<const Tick> TrialRun::step() { return next(); }

void TrialRun::run() {
  while (!finished()) next();
}

bool TrialRun::step_or_wait() {
  if (!waits_) ticks_ = advance();
  waits_ = !loop_.act_or_wait(ticks_);
  if (!waits_) observe(ticks_);
  return waits_;
}

TrialResult TrialRun::finish() {
  loop_.finish();
  for (const auto& sensor : sensors_) sensor->finish();
  judge_.finish(sensors_);
  if (recorder_) check_finite(result_.record);
  check_last_tick(result_.record, sensors_, *simulation_, sampler_);
  result_.time_step = std::numeric_limits<double>::infinity();
  for (std::size_t pad = 0; pad < sensors_.size(); ++pad) {
    if (scene_.sensors[pad].follows.empty()) result_.time_step = std::min(result_.time_step, simulation_->time_step(pad));
  }
  result_.notice = loop_.notice();
  result_.record.libraries = libraries_of(scene_);
  if (!scene_.model.empty()) result_.record.model_sha256 = file_sha256(scene_.model);
  return std::move(result_);
}

TrialResult run_trial(const Scene& scene, std::uint64_t trial, Recording recording, double max_bytes,
                      const std::atomic<bool>* interrupt, std::atomic<double>* share) {
  const InterruptScope scope(interrupt);
  TrialRun trial_run(scene, trial, recording, max_bytes, interrupt, {}, share);
  trial_run.run();
  return trial_run.finish();
}

}  // namespace slipbench
