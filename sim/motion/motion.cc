#include "sim/motion/motion.h"

#include "sim/motion/guided.h"
#include "sim/motion/lift.h"

namespace slipbench {

const std::vector<MotionKind>& motion_catalogue() {
  static const std::vector<MotionKind> kinds{
      stage_motion(), lift_motion(), guided_motion(), wander_motion(), press_motion(), rub_motion(),
  };
  return kinds;
}

}  // namespace slipbench
