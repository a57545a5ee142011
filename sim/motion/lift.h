// The arm of a grasp: waits, lifts, and may carry on sideways, tilt and shake.
#pragma once

#include "sim/motion/motion.h"

namespace slipbench {

// The arm begins at the origin, aligned with the world. See describe().
MotionKind lift_motion();

// When the arm begins to rise and when it has risen [s].
struct LiftTimes {
  double start, end;
};
// `parameters`: of the motion `lift`.
LiftTimes lift_times(const Parameters& parameters);

}  // namespace slipbench
