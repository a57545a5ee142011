#include "sim/motion/motion_catalogue.h"

#include "sim/motion/guided.h"

namespace slipbench {

const std::vector<MotionKind>& motion_catalogue() {
  static const std::vector<MotionKind> kinds{
      stage_motion(), lift_motion(), guided_motion(), wander_motion(), press_motion(), rub_motion(),
  };
  return kinds;
}

}  // namespace slipbench
