// Pads as fields with explicit springs, stepped by MuJoCo's RK4.
#pragma once

#include <cstddef>
#include <optional>

#include "sim/mujoco/modes/field_pads.h"
#include "sim/mujoco/modes/spring_limit.h"

namespace slipbench {

// A step gives the truth at its end, and leaves the data there.
class RungeKuttaFieldPads final : public FieldPads {
 public:
  // `world` must have the step's data and outlive the object.
  RungeKuttaFieldPads(DynamicWorld& world, const DynamicSetup& setup, bool stored_energy_known);

  void begin() override;
  void take_tick(std::size_t tick, RunWatch& watch) override;
  [[nodiscard]] WatchSettings watch_settings(const WatchLimits& limits) const override;
  PadEnergy read_energy() override;

 private:
  std::optional<SpringLimit> limit_;  // unless the caller allows long steps
};

}  // namespace slipbench
