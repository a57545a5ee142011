// Input of the modes: a scene with moving bodies, and its pads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/api/motion.h"
#include "sim/api/pad_layout.h"
#include "sim/mujoco/modes/dynamic_options.h"
#include "sim/scene/scene.h"
#include "sim/stage/stage_setup.h"
#include "sim/stage/step_plan.h"

namespace slipbench {

struct DynamicSetup {
  const Scene& scene;  // its sensors are the pads that exert forces
  std::span<const PadLayout* const> layouts;
  std::size_t read;           // number of the pads that are read, which come first
  std::vector<double> rates;  // Hz, of these
  std::uint64_t trial;
  const Motion* motion;  // of the stage; null without a stage
  const DynamicSimulationOptions& options;

  // Returns the limit by the motion of the stage or the arm, if there is one.
  [[nodiscard]] StepLimit limit_of_motion() const {
    const Motion* const moves = options.arm != nullptr ? options.arm : motion;
    return moves != nullptr ? step_limit(*moves, {}, 0.0) : StepLimit{};
  }
};

}  // namespace slipbench
