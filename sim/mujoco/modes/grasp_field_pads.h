// The pads of a grasp as fields, whose free bodies are stepped without MuJoCo (free_bodies.h).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pose.h"
#include "sim/mujoco/linear/average_acceleration.h"
#include "sim/mujoco/modes/field_pads.h"
#include "sim/mujoco/modes/field_plan.h"
#include "sim/mujoco/modes/free_bodies.h"
#include "sim/mujoco/modes/spring_limit.h"

namespace slipbench {

// The truth of a tick is that at the start of the step from it.
class GraspFieldPads final : public FieldPads {
 public:
  // `carriages` [m/s2, rad/s2]: accelerations in the world of the carriages of the fingers' springs,
  // which the caller keeps up to date. It and `world`, which must have the step's data, must outlive
  // the object.
  GraspFieldPads(DynamicWorld& world, const DynamicSetup& setup, const FieldPlan& plan, const std::array<Vector6d, 2>& carriages);

  void take_tick(std::size_t tick, RunWatch& watch) override;
  [[nodiscard]] WatchSettings watch_settings(const WatchLimits& limits) const override;
  [[nodiscard]] double kinetic_energy(const DynamicWorld& world, const Eigen::VectorXd& v, Eigen::VectorXd& space) const override;

 private:
  void step_bodies(std::size_t tick);
  void average(std::size_t tick);

  FreeBodies free_bodies_;
  std::optional<HeldBodies> held_bodies_;  // with implicit springs
  const std::array<Vector6d, 2>& carriages_;
  // Inertia added by the springs of each contact, about the held body, or the body on which that
  // stands.
  std::vector<Matrix6d> added_;
  std::optional<SpringLimit> limit_;  // unless the caller allows long steps
};

}  // namespace slipbench
