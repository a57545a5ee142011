// Pads of articulated pillars that move as prescribed against one analytic surface.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/api/simulation.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"
#include "sim/scene/scene.h"

namespace slipbench {

struct ArticulatedSettings;
struct PillarSettings;

// The articulated counterpart of a Field with its ContactLabels. The pad's carrier is a MuJoCo body
// with six degrees of freedom. Its position and velocity are overwritten before every step with
// those of the prescribed motion, so that its own motion has no effect. (A mocap body would not do:
// it has no velocity, and friction against it is wrong.)
class ArticulatedStage {
 public:
  // `dt` > 0: the step [s] of every call of step(). No tip moves faster than `speed` [m/s]. MuJoCo
  // divides the step into equal parts of at most the recipe's longest step, 2 ms, and its longest
  // path, 0.1 mm. Throws std::invalid_argument like add_articulated_pad(), for dt <= 0, and for a
  // DistanceGrid, which is not a MuJoCo geom; std::runtime_error if MuJoCo cannot compile the model.
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, double dt, double speed = 0.0);
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, double dt, double speed,
                   const ArticulatedSettings& recipe);
  // With any pillars: a step of the simulation is one step of MuJoCo with the pillars' dt.
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, const PillarSettings& pillars);
  ~ArticulatedStage();

  // Moves the pad on a straight path to `pad_in_surface`, which it reaches at `time` [s], in a step
  // of the stage's `dt`. The first call places the pad: tips inside the surface start on it,
  // without tangential strain. Throws std::runtime_error on any MuJoCo warning that mjData counts,
  // with its text, the time and the body.
  const ContactFrame& step(const Pose& pad_in_surface, double time);

  [[nodiscard]] const ContactFrame& frame() const;

 private:
  struct World;
  ArticulatedStage(const PadLayout& layout, const Surface& surface, Friction friction, const PillarSettings& pillars, int parts);
  std::unique_ptr<World> world_;
};

// `fidelity: articulated` and `mujoco_contact`: a scene of prescribed motion with MuJoCo's own
// bodies, joints and contacts for the elements. It has the same scene, truth and bodies as
// StageSimulation, with an ArticulatedStage per pad. Throws SceneValueError as that does, and for
// features that articulated pads lack: effects, and a kinetic friction different from the static
// one.
std::unique_ptr<Simulation> articulated_simulation(const Scene& scene, std::span<const PadLayout* const> pads,
                                                   std::span<const double> output_rates, std::uint64_t trial);

}  // namespace slipbench
