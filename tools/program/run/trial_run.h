// A trial in steps, for whoever closes its loop from outside. run_trial() is all of it at once.
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
#include "sim/core/controller.h"
#include "sim/core/sensor.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tools/program/run/control_loop.h"
#include "tools/program/run/judge.h"
#include "tools/program/run/recorder.h"
#include "tools/program/run/run_trial.h"

namespace slipbench {

class TrialRun {
 public:
  // As run_trial(). `controller`, of a grasp alone: makes the one that stands in the place of the scene's.
  using ControllerInPlace = std::function<std::unique_ptr<Controller>(const GripSource& source)>;
  TrialRun(Scene scene, std::uint64_t trial, Recording recording, double max_bytes, const std::atomic<bool>* interrupt,
           const ControllerInPlace& controller = {});
  ~TrialRun() = default;
  TrialRun(const TrialRun&) = delete;
  TrialRun& operator=(const TrialRun&) = delete;

  [[nodiscard]] bool finished() const { return sampler_.finished(); }
  // All of it. Throws as run_trial().
  void run();
  // For a grasp whose commands come from outside: to the next instant at which a pad has a tick; true where loop().awaiting() asks for a command
  // at that instant. Then loop().command() is to be called, and this again, which goes on at the same instant. Throws as run_trial().
  bool step_or_wait();
  // Once, at the end, or before it where nobody wants the rest.
  TrialResult finish();

  [[nodiscard]] ControlLoop& loop() { return loop_; }
  [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
  [[nodiscard]] HeldBox* box() { return simulation_->held_box(); }  // null: the scene is no grasp
  [[nodiscard]] std::span<const std::unique_ptr<Sensor>> sensors() const { return sensors_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  // To the next instant; what is at it is handed to the loop.
  std::span<const Tick> advance();
  void observe(std::span<const Tick> ticks);

  Scene scene_;
  std::vector<std::unique_ptr<Sensor>> sensors_;
  std::unique_ptr<Simulation> simulation_;
  TrialResult result_;
  Sampler sampler_;
  Judge judge_;
  std::optional<Recorder> recorder_;
  ControlLoop loop_;
  const std::atomic<bool>* interrupt_;
  std::size_t steps_ = 0;
  std::span<const Tick> ticks_;  // at which a command is waited for
  bool waits_ = false;
};

}  // namespace slipbench
