// Runs a trial step by step, for callers that close its loop themselves. run_trial() runs it at
// once.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "controllers/controller_kinds.h"
#include "sim/api/controller.h"
#include "sim/api/detector.h"
#include "sim/api/sensor.h"
#include "sim/api/simulation.h"
#include "sim/grasp/grasp.h"
#include "sim/scene/scene.h"
#include "tools/trial/control_loop.h"
#include "tools/trial/judge.h"
#include "tools/trial/recorder.h"
#include "tools/trial/run_trial.h"
#include "tools/trial/sampler.h"

namespace slipbench {

class TrialRun {
 public:
  // Replacements of parts that the scene names; empty: none.
  struct Replacements {
    std::function<std::unique_ptr<Controller>(const GripSource& source)> controller;  // for grasps only
    std::unique_ptr<Detector> detector;  // reads the sensor that the scene's detector reads
  };
  // Other arguments as for run_trial().
  TrialRun(Scene scene, std::uint64_t trial, Recording recording, double max_bytes, const std::atomic<bool>* interrupt,
           Replacements replacements = {}, std::atomic<double>* share = nullptr);
  ~TrialRun() = default;
  TrialRun(const TrialRun&) = delete;
  TrialRun& operator=(const TrialRun&) = delete;

  [[nodiscard]] bool finished() const { return sampler_.finished(); }
  // Advances to the next instant at which a pad has a tick, lets the loop act and records. Returns
  // the ticks at that instant, in the order of pads, valid until the next call. Throws as
  // run_trial().
  std::span<const Tick> step();
  // Runs the whole trial. Throws as run_trial().
  void run();
  // For a grasp commanded from outside: advances to the next instant at which a pad has a tick.
  // Returns true if loop().awaiting() needs a command at that instant: then call loop().command()
  // and this function again, which continues at the same instant. Throws as run_trial().
  bool step_or_wait();
  // Call once, at the end or earlier to skip the rest.
  TrialResult finish();

  [[nodiscard]] ControlLoop& loop() { return loop_; }
  [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
  // The gripper and its box; null if the simulation has none.
  [[nodiscard]] HeldBox* box() { return dynamic_cast<HeldBox*>(simulation_.get()); }
  [[nodiscard]] std::span<const std::unique_ptr<Sensor>> sensors() const { return sensors_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  // Advances to the next instant and passes its ticks to the loop.
  std::span<const Tick> advance();
  void observe(std::span<const Tick> ticks);
  // Body of step(), inlined into run().
  std::span<const Tick> next();

  Scene scene_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::unique_ptr<Simulation> simulation_;
  TrialResult result_;
  Sampler sampler_;
  Judge judge_;
  std::optional<Recorder> recorder_;
  ControlLoop loop_;
  const std::atomic<bool>* interrupt_;
  std::atomic<double>* share_;
  std::size_t steps_ = 0;
  std::span<const Tick> ticks_;  // ticks that wait for a command
  bool waits_ = false;
};

}  // namespace slipbench
