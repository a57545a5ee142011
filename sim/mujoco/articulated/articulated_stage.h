// Pads of articulated pillars that move as prescribed against one analytic surface.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"
#include "sim/field/surface/surface.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

struct ArticulatedSettings;
struct PillarSettings;

// The articulated counterpart of a Field with its ContactLabels. The pad's carrier is a MuJoCo body with six degrees of freedom
// whose position and velocity are overwritten before every step with those of the prescribed motion, so nothing of its own motion
// is kept. (A mocap body would not do: it has no velocity, and friction against it is wrong.)
class ArticulatedStage {
 public:
  // `dt` > 0: the step [s] of every call of step(); MuJoCo takes it in equal parts of at most the recipe's longest step, 2 ms.
  // Throws std::invalid_argument as add_articulated_pad() does, for dt <= 0 and for a DistanceGrid, which is no MuJoCo geom, and
  // std::runtime_error when MuJoCo cannot compile the model.
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, double dt);
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, double dt,
                   const ArticulatedSettings& recipe);
  // With any pillars: a step of the simulation is one of MuJoCo's, of the pillars' dt.
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, const PillarSettings& pillars);
  ~ArticulatedStage();

  // Moves the pad on a straight way to `pad_in_surface`, which it reaches at `time` [s] after the stage's `dt`. The first call
  // places the pad: tips that would be inside the surface begin on it, unstrained sideways.
  // Throws std::runtime_error on any MuJoCo warning that mjData counts, with its text, the time and the body.
  const ContactFrame& step(const Pose& pad_in_surface, double time);

  [[nodiscard]] const ContactFrame& frame() const;

 private:
  struct World;
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, const PillarSettings& pillars, int parts);
  std::unique_ptr<World> world_;
};

// `fidelity: articulated` and `mujoco_contact`: a scene of prescribed motion with MuJoCo's own bodies, joints and contacts for
// the elements. The same scene, the same truth and bodies as StageSimulation's, from an ArticulatedStage a pad.
// As StageSimulation's. Throws SceneValueError as that does, and for what articulated pads cannot have: effects, and a kinetic friction
// that is not the static one.
std::unique_ptr<Simulation> articulated_simulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                                   std::span<const double> output_rates, std::uint64_t trial);

}  // namespace slipbench
