// A hexapod stage that presses the pad onto a surface and moves it sideways.
#pragma once

#include "sim/motion/motion.h"

namespace slipbench {

// The pad approaches, presses, dwells, slides and/or turns, may stop, reverse, and lift off. See describe().
MotionKind stage_motion();

}  // namespace slipbench
