// The prescribed motions of the bench, one line per motion in motion_catalogue.cc.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/api/motion.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Throws SceneValueError for `key` if its time [s] is earlier than `pressed` [s], when pressing
// ends, by more than the rounding of decimal text.
void refuse_early(const std::string& key, double time, double pressed);

// A hexapod stage: the pad approaches, presses, dwells, slides and/or turns, may stop, reverse, and
// lift off.
MotionKind stage_motion();
// The pad approaches, presses, holds and slowly retreats, only vertically, while something else
// moves the touched body.
MotionKind press_motion();
// A finger pressed on a spot of its round skin rubs, slides or turns there by fits and starts. The
// pad's skin is modelled as the lower half of an ellipsoid.
MotionKind rub_motion();
// A hand: the pad stands over the surface, comes down and wanders at random in all six coordinates.
MotionKind wander_motion();

// All kinds. The first one of a stage and the first one of an arm are the defaults of scenes.
const std::vector<MotionKind>& motion_catalogue();
// The default of a scene: of a grasp's arm if `of_arm`, otherwise of a stage.
const MotionKind& default_motion(bool of_arm);
// Returns the kind with this name, or null for an unknown name.
const MotionKind* find_motion(std::string_view name);

// The arm starts at the origin, aligned with the world. See describe().
MotionKind lift_motion();

// Times at which the arm begins to rise and has risen [s].
struct LiftTimes {
  double start, end;
};
// `parameters`: of the motion `lift`.
LiftTimes lift_times(const Parameters& parameters);

}  // namespace slipbench
