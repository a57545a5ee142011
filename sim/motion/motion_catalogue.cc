#include "sim/motion/motion_catalogue.h"

#include <algorithm>

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

const MotionKind& default_motion(bool of_arm) { return *std::ranges::find(motion_catalogue(), of_arm, &MotionKind::of_arm); }

const MotionKind* find_motion(std::string_view name) {
  const auto found =
      std::ranges::find(motion_catalogue(), name, [](const MotionKind& kind) { return std::string_view(kind.about.name); });
  return found == motion_catalogue().end() ? nullptr : &*found;
}

}  // namespace slipbench
