// How a scene with moving bodies is to be simulated.
#pragma once

#include "sim/mujoco/modes/watch.h"
#include "sim/scene/scene.h"

namespace slipbench {

class Motion;
struct Hand;  // gripper_model.h

struct DynamicSimulationOptions {
  // False: for tests of the rules of watch.h, which must see the effects of a too long step.
  bool refuse_long_steps = true;
  WatchLimits limits{};
  FieldSolver hand_solver = FieldSolver::explicit_springs;  // of a grasp (average_acceleration.h)
  // The fingers of a grasp, whose springs the caller of step() applies; needed only in the
  // constructor.
  const Hand* hand = nullptr;
  // The motion of the arm, which the caller of step() applies and which limits the step; needed only
  // in the constructor.
  const Motion* arm = nullptr;
};

}  // namespace slipbench
