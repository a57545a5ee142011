// A finger that is pressed on a spot of its round skin and rubs, slides or turns there by fits and starts.
#pragma once

#include "sim/motion/motion.h"

namespace slipbench {

// See describe(). The pad's skin is taken as the lower half of an ellipsoid.
MotionKind rub_motion();

}  // namespace slipbench
