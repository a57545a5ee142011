#include "sim/motion/motion.h"

#include "sim/motion/lift.h"
#include "sim/motion/stage.h"

namespace slipbench {

const std::vector<MotionKind>& motion_catalogue() {
  static const std::vector<MotionKind> kinds{
      stage_motion(),
      lift_motion(),
  };
  return kinds;
}

}  // namespace slipbench
