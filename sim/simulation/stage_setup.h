// What every simulation of prescribed motion begins with: the stage and the surface that it presses on.
#pragma once

#include <cstdint>
#include <memory>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/effect.h"
#include "sim/motion/motion.h"
#include "sim/scene/scene.h"
#include "sim/simulation/surfaces.h"

namespace slipbench {

// The scene's motion in trial number `trial`. Throws SceneValueError when its parameters contradict each other.
std::unique_ptr<Motion> make_motion(const Scene& scene, std::uint64_t trial);

// Throws SceneValueError where the scene's motion has motors that shake: benches other than StageSimulation do not.
void refuse_motors(const Motion& motion);

struct StageSetup {
  std::unique_ptr<Motion> motion;
  PlacedSurface surface;
};

// Throws SceneValueError as make_motion().
StageSetup set_up_stage(const Scene& scene, std::uint64_t trial);

// Throws SceneValueError when a pad at `pose` in the world stands inside the surface as the effects have textured it.
void refuse_inside(const PadLayout& pad, const PlacedSurface& surface, const FieldEffects& effects, const Pose& pose);

// The farthest tip of a pad from its origin [m].
double reach_of(const PadLayout& layout);

}  // namespace slipbench
