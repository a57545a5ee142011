// The scene's part in every simulation of prescribed motion: its motion, the surface that it presses on, and the catalogues of both.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/field/effect.h"
#include "sim/field/surface/surface.h"
#include "sim/motion/motion.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The catalogues of everything in sim/ that a scene may name (materials, surfaces, motions, effects). Sensors and electronics are
// added by whoever composes the program.
struct Catalogues;
void add_sim_catalogues(Catalogues& catalogues);

// A shape in the world: its highest point or line is at z = 0 unless its position says otherwise.
struct PlacedSurface {
  Surface shape;
  Pose pose;  // of the surface frame in the world
};

struct SurfaceKind {
  Entry about;
  PlacedSurface (*create)(const Parameters& parameters);
};

// All shapes that a scene may press on, one line each.
const std::vector<SurfaceKind>& surface_catalogue();

// All shapes, one line each: what `bodies` of a scene may name and `describe` prints. sim/mujoco builds them.
const std::vector<Entry>& body_catalogue();

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
