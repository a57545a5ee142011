// The scene's part in every simulation of prescribed motion: its motion, the surface that it
// presses on, and the catalogues of both.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/api/effect.h"
#include "sim/api/motion.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/scene/scene.h"
#include "sim/stage/step_plan.h"

namespace slipbench {

// Adds everything in sim/ that a scene may name (materials, surfaces, motions, effects). Sensors
// and electronics are added by the code that composes the program.
struct Catalogues;
void add_sim_catalogues(Catalogues& catalogues);

// A shape in the world: its highest point or line is at z = 0 unless its position differs.
struct PlacedSurface {
  Surface shape;
  Pose pose;  // of the surface frame in the world
};

struct SurfaceKind {
  Entry about;
  PlacedSurface (*create)(const Parameters& parameters);
};

// All shapes that a scene may press on.
const std::vector<SurfaceKind>& surface_catalogue();

// All shapes that `bodies` of a scene may name and `describe` prints. sim/mujoco builds them.
const std::vector<Entry>& body_catalogue();

// Makes the scene's motion in trial number `trial`. Throws SceneValueError if its parameters
// contradict each other.
std::unique_ptr<Motion> make_motion(const Scene& scene, std::uint64_t trial);

// Throws SceneValueError if the scene's motion has vibrating motors: only StageSimulation supports
// them.
void refuse_motors(const Motion& motion);

struct StageSetup {
  std::unique_ptr<Motion> motion;
  PlacedSurface surface;
};

// Throws SceneValueError like make_motion().
StageSetup set_up_stage(const Scene& scene, std::uint64_t trial);

// Returns the shorter one of the longest step that `effects` resolve at the top speed of a pad of
// `reach` [m], and the longest one of the motion.
StepLimit step_limit(const Motion& motion, const FieldEffects& effects, double reach);

// Throws SceneValueError if a pad at `pose` in the world is inside the surface as textured by the
// effects.
void refuse_inside(const PadLayout& pad, const PlacedSurface& surface, const FieldEffects& effects, const Pose& pose);

// Returns the distance of a pad's farthest tip from its origin [m].
double reach_of(const PadLayout& layout);

}  // namespace slipbench
