// A hand that presses, pushes, tilts and turns the pad at random.
#pragma once

#include "sim/motion/motion.h"

namespace slipbench {

// The pad stands still over the surface, comes down and wanders in all six coordinates. See describe().
MotionKind wander_motion();

}  // namespace slipbench
