// From a scene to a MuJoCo model.
//
// The model file, if there is one, is read unchanged. The following is added:
// - the scene's bodies, each a body with one geom of the same name,
// - for sensors without a site a body without geoms, `stage_name`, with a free joint and a site.
//   The simulation overwrites its position and velocity before every step with those of the motion.
//   (A mocap body would not do: it has no velocity, so a pad on it would have no dashpot and
//   friction against it would be wrong.) Its mass, `stage_mass`, makes it insensitive to contacts:
//   a force of 100 N changes its velocity by 1e-7 m/s in a step of 1 ms, and that is overwritten
//   before it has moved. It has no weight (gravcomp),
// - with fidelity field one instance of the plugin `slipbench.field` per sensor, named as the
//   sensor, with the attributes that a user would write, except for the elements
//   (LayoutsInMemory); with fidelity articulated instead the pillars of articulated.h, as children of
//   the pad's body,
// - for a grasp the two fingers of a hand (below),
// - an exclusion of MuJoCo's own contact between a pad's body and every body that it touches: the
//   field is their contact, and no force may count twice. MuJoCo excludes only whole bodies,
// - for implicit fields the settings of implicit.h.
// Keyframes of the model are omitted: they do not fit once bodies are added.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "sim/api/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/mujoco/models/gripper_model.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/scene/scene.h"

namespace slipbench {

class LayoutsInMemory;  // pad_config.h

// At the middle of the box, with its axes: the pad frame of its corners, which are elements of a
// field on the table. So the table's friction is Coulomb's, and needs no solver.
inline constexpr const char* corner_site = "slipbench/box corners";

// of the names of bodies that a scene does not name
inline constexpr const char* own_prefix = "slipbench/";
inline constexpr const char* stage_name = "slipbench/stage";
inline constexpr double stage_mass = 1e6;  // kg, and kg m^2

// Builds the model of a scene. Without a model file the integrator is implicitfast, contacts have
// elliptic cones and ten noslip iterations: with three a box that two pads hold creeps by 0.2 um/s,
// with ten by less than 1e-4 um/s (measured). With implicit fields, which do not allow noslip, it is
// discrete, and impratio 1e4 replaces noslip. `pads`: one layout per sensor. `hand`: null without
// a hand. With one, all forces are those of pads and of the fingers' springs, explicit for MuJoCo:
// the integrator is Euler without implicit damping, and MuJoCo's contacts and solver are off, which
// halves the time of a step. The time step is the model's own, or MuJoCo's default. `layouts_in_memory` must
// live as long as data is made from the model. Throws SceneValueError if the model cannot be read
// or compiled, or if a site, geom, body or name is invalid.
ModelPointer build_model(const Scene& scene, std::span<const PadLayout* const> pads, std::uint64_t trial, const Hand* hand,
                         LayoutsInMemory& layouts_in_memory);

// The same with articulated pads, for steps of step_for(longest) [s], where `longest` is the result
// of longest_articulated_step() for the scene's bodies; infinite with a `contact` of the scene. The
// options of `contact` or of the recipe (set_pillar_options()) replace the model's, also for its
// other contacts; those of the scene's own bodies have the solref and solimp of `contact`. With a
// hand, contacts and solver are on. An element's dashpots are its layout's, plus the scene's
// `damping` parallel to each spring. Throws SceneValueError also for a touched mesh, and for flags
// and compiler attributes that would disable the pillars; and all that step_for() throws.
ModelPointer build_articulated_model(const Scene& scene, std::span<const PadLayout* const> pads,
                                     const std::function<double(double longest)>& step_for, const Hand* hand = nullptr);

// Name of the site of a sensor's pad, and the prefix of its articulated pillars.
std::string site_of(const SensorScene& sensor);
std::string pillars_of(const SensorScene& sensor);

}  // namespace slipbench
