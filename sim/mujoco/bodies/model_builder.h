// From a scene to a MuJoCo model: the one place where it is done.
//
// The model file, if there is one, is read as it is. To it are added
//   - the scene's bodies, each a body with one geom of the same name,
//   - for sensors without a site a body without geoms, `stage_name`, with a free joint and a site. Whoever steps the model overwrites
//     its position and velocity before every step with those of the motion. (A mocap body would not do: it has no velocity, so a pad
//     on it would have no dashpot and friction against it would be wrong.) Its mass, `stage_mass`, makes it deaf to what it touches:
//     a force of 100 N changes its velocity by 1e-7 m/s in a step of 1 ms, and that is overwritten before it has moved. No weight
//     pulls it (gravcomp),
//   - with fidelity field one instance of the plugin `slipbench.field` a sensor, named as the sensor, with the attributes that a
//     user would write, but for the elements (HandedLayouts); with fidelity articulated in its place the pillars of articulated.h, as children of the pad's body,
//   - for a grasp the two fingers of a hand (below),
//   - an exclusion of MuJoCo's own contact between a pad's body and every body that it touches: the field is their contact, and no
//     force may count twice. It is for the whole bodies, since MuJoCo knows no other,
//   - for implicit fields what implicit.h asks for.
// Keyframes of the model are left out: they cannot fit once bodies are added.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/mujoco/mujoco_call.h"
#include "sim/scene/scene.h"

struct mjsBody_;

namespace slipbench {

class HandedLayouts;  // pad_instance.h

// The two fingers of a grasp as MuJoCo bodies.
//
// Each is a free body on the springs of dynamic_state.h. Neither arm nor drive yields, so neither needs a body, and there is no heavy one
// in the model. Whoever steps it sets the applied forces to FingerSpring::wrench() and what carries the finger's weight: its springs are
// counted from where it hangs. A finger's frame and its mass are at its pivot, so that it does not pitch when it is sped up.
struct Hand {
  const Parameters& grip;  // of the entry `grip`
  double yaw, pitch;       // rad, about the arm's Z and then the hand's Y
  double opening;          // m, between the pads' origins at the start
  const char* box;         // name of the body that it takes
};

// The sensor's finger first: it is on the -X side and closes towards +X.
struct FingerNames {
  const char *body, *site;  // `site`: the pad frame, Z against the closing direction, Y up
};
inline constexpr std::array<FingerNames, 2> finger_names{{
    {"slipbench/finger", "slipbench/finger pad"},
    {"slipbench/second finger", "slipbench/second finger pad"},
}};

// In the middle of the box, axes alike: the pad frame of its corners, which stand on the table as elements of a field do. So the table's
// friction is Coulomb's, and no solver is needed for it.
inline constexpr const char* corner_site = "slipbench/box corners";

// Where the carriage of finger 0 or 1 is in the arm's frame, at its pivot: x is its closing direction. `opening` as in Hand.
Pose carriage_in_arm(const Hand& hand, std::size_t finger, double opening);

// Adds both fingers to `world`, where their carriages are when the arm is at the origin.
void add_fingers(mjsBody_* world, const Hand& hand);

inline constexpr const char* own_prefix = "slipbench/";  // of the names of bodies that a scene does not name
inline constexpr const char* stage_name = "slipbench/stage";
inline constexpr double stage_mass = 1e6;  // kg, and kg m^2

// The integrator of a scene without a model of its own is implicitfast, its contacts have elliptic cones and ten noslip iterations:
// with fewer a box on a table creeps under a sideways force (shared MUJOCO.md, section C). With implicit fields, which bear no noslip,
// it is discrete, and impratio 1e4 does what noslip would.
// `pads`: one layout a sensor. `hand`: null where there is none. With one, all forces are those of pads and of the fingers' springs, which are
// explicit in any case: the integrator is Euler without implicit damping, and MuJoCo's contacts and solver are off, which halves a step.
// The time step is the model's own, or MuJoCo's default.
// `handed` must live as long as data is made of the model.
// Throws SceneValueError when the model cannot be read or compiled, and when a site, geom, body or name does not suit.
ModelPointer build_model(const Scene& scene, std::span<const PadLayout* const> pads, std::uint64_t trial, const Hand* hand,
                         HandedLayouts& handed);

// The same with articulated pads, for steps of step_for(longest) [s], `longest` being what longest_articulated_step() allows on the
// scene's bodies; infinite with a `contact` of the scene. Its options or the recipe's (set_pillar_options()) take the place of
// the model's, also for its other contacts, of which those of the scene's own bodies have the solref and solimp of `contact`.
// With a hand, contacts and solver are on. An element's dashpots are its layout's and the scene's `damping` beside each spring.
// Throws SceneValueError also for a touched mesh, and for flags and compiler attributes with which there would be no pillars; and
// what step_for() throws.
ModelPointer build_articulated_model(const Scene& scene, std::span<const PadLayout* const> pads,
                                     const std::function<double(double longest)>& step_for, const Hand* hand = nullptr);

// Name of the site that is a sensor's pad, and the prefix of its articulated pillars.
std::string site_of(const SensorScene& sensor);
std::string pillars_of(const SensorScene& sensor);

}  // namespace slipbench
