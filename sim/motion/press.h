// A stage that presses the pad onto a surface, holds it there and slowly lets it go, while something else moves what it touches.
#pragma once

#include "sim/motion/motion.h"

namespace slipbench {

// The pad approaches, presses, holds and retreats, along the vertical alone. See describe().
MotionKind press_motion();

}  // namespace slipbench
