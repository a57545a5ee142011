// Applies the rules of watch.h to a run.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "sim/core/pose.h"
#include "sim/mujoco/modes/dynamic_pads.h"
#include "sim/mujoco/modes/dynamic_world.h"
#include "sim/mujoco/modes/watch.h"

namespace slipbench {

// A mode calls begin_step() and end_step() around each step of the bodies, and at each tick one of
// the checks. A check throws FailedRun if the run breaks a rule.
class RunWatch {
 public:
  // `world` and `pads`, at the start of the run, must outlive the watch.
  RunWatch(const DynamicWorld& world, DynamicPads& pads, const WatchLimits& limits);

  void begin_step();
  void end_step();

  // Checks the tick at `time` [s] from which the last step started.
  void check_step_from(double time);
  // Checks the tick to which it led.
  void check_step_to(double time);
  // Checks the first tick, to which no step leads.
  void check_start(double time);

 private:
  struct WeighedBody {
    int body;
    int dof;  // first of its six
    WeightRule rule;
  };

  void note_works();
  void check_energy(double time, const Eigen::VectorXd& velocity);
  void weigh(double time, const Eigen::VectorXd& velocity);
  [[nodiscard]] double weight_work() const;
  void note_centres();

  const DynamicWorld& world_;
  DynamicPads& pads_;
  WatchSettings settings_;
  EnergyRule energy_;
  std::vector<WeighedBody> weighed_;
  std::vector<int> moving_;  // bodies that the ejection rule watches
  WatchedEnergy pending_;    // works of the step that began at the last checked tick
  // Velocities of the last step, `after_` with the stage as MuJoCo left it.
  Eigen::VectorXd before_, after_;
  Eigen::VectorXd pad_force_;  // generalized, of that step
  Vector6d stage_force_ = Vector6d::Zero(), stage_way_ = Vector6d::Zero();
  Eigen::VectorXd mean_, space_;
  double last_slip_loss_ = 0.0;  // J, of the last step
  std::vector<double> centres_;  // [3 nbody] m, at the last tick
};

}  // namespace slipbench
