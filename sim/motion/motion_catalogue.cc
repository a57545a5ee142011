#include "sim/motion/motion_catalogue.h"

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "sim/motion/guided.h"

namespace slipbench {

void refuse_early(const std::string& key, double time, double pressed) {
  constexpr double rounding = 1e-12;  // relative
  if (time >= pressed * (1.0 - rounding)) return;
  const std::string early = format_quantity(time, Quantity::time);
  throw SceneValueError(key, early + " is too early; expected at least " +
                                 bound_in_unit_of(early, pressed, Quantity::time, Bound::lower) + ", when pressing ends");
}

const std::vector<MotionKind>& motion_catalogue() {
  static const std::vector<MotionKind> kinds{
      stage_motion(), lift_motion(), guided_motion(), wander_motion(), press_motion(), rub_motion(),
  };
  return kinds;
}

}  // namespace slipbench
