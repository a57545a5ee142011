// Pads as fields with implicit springs, which MuJoCo's solver steps (implicit.h).
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "sim/mujoco/modes/field_pads.h"

namespace slipbench {

// The truth of a tick is that at the start of the step from it. Any step is accurate enough.
class ImplicitFieldPads final : public FieldPads {
 public:
  // `world` must have the step's data and outlive the object.
  ImplicitFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known);

  void take_tick(std::size_t tick, RunWatch& watch) override;
  [[nodiscard]] WatchSettings watch_settings(const WatchLimits& limits) const override;
  void find_force(Eigen::VectorXd& force) const override;
  PadEnergy read_energy() override;
  [[nodiscard]] Eigen::Vector3d force_on(int body, int dof, const Eigen::VectorXd& force) const override;

 private:
  void refuse_missing_springs(double time) const;
};

}  // namespace slipbench
