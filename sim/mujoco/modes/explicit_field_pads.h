// Pads as fields with explicit springs, stepped by MuJoCo's one-stage integrators.
#pragma once

#include <cstddef>
#include <optional>

#include "sim/mujoco/modes/field_pads.h"
#include "sim/mujoco/modes/spring_limit.h"

namespace slipbench {

// The truth of a tick is that at the start of the step from it.
class ExplicitFieldPads final : public FieldPads {
 public:
  // `world` must have the step's data and outlive the object.
  ExplicitFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known);

  void take_tick(std::size_t tick, RunWatch& watch) override;
  [[nodiscard]] WatchSettings watch_settings(const WatchLimits& limits) const override;

 private:
  std::optional<SpringLimit> limit_;  // unless the caller allows long steps
};

}  // namespace slipbench
