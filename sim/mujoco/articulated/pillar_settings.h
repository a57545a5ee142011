// Settings of a pad's elements as MuJoCo bodies, and of the evaluation of their contact.
#pragma once

#include <mujoco/mujoco.h>
#include <array>
#include <limits>
#include <optional>
#include <string_view>

#include "sim/core/parameters.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Settings of a pad's elements as MuJoCo bodies with joints and sphere tips, and of the evaluation
// of their contact. Filled by the recipe of `fidelity: articulated` or, with `fidelity:
// mujoco_contact`, by the scene's `contact`.
//
// The reasons for the values are in the sources of both.
struct PillarSettings {
  double dt = 0.0;  // s, of the steps for which all values hold

  // Options of the whole model.
  mjtIntegrator integrator = mjINT_DISCRETE;
  mjtCone cone = mjCONE_ELLIPTIC;
  mjtSolver solver = mjSOL_NEWTON;
  double impratio = 1.0;
  int iterations = 100;       // limit of the main solver
  int noslip_iterations = 0;  // limit
  double tolerance = 0.0;     // of the main solver
  double noslip_tolerance = 0.0;
  std::optional<bool> refsafe;  // the flag; empty: the model's own

  // Element's tip.
  double tip_mass = 0.0;       // kg
  double tip_radius = 0.0;     // m
  double damping_ratio = 0.0;  // of a free tip on its springs, all directions

  // Contact pair.
  std::array<mjtNum, mjNREF> solref{}, solreffriction{};
  std::array<mjtNum, mjNIMP> solimp{};

  // The slide along an element's axis is stiffer than the element, to compensate for the contact's
  // compliance, see normal_slide() in articulated.cc: the contact's stiffness over its effective
  // mass, times dt^2. Infinite: slides are as stiff as the elements.
  double contact_ratio = std::numeric_limits<double>::infinity();

  // True if the mean inertia, which scales the solvers' tolerances, includes a prescribed pad's
  // heavy carrier.
  bool carrier_in_scale = false;

  // Whole number of steps in which indented tips come to rest before the run, see
  // steps_to_settle().
  double settling_steps = 0.0;

  // The state rule, see ArticulatedContact.
  double cone_share = 0.0;
  double least_speed = 0.0;  // m/s
  // m/s; infinite: the cone alone decides
  double creep_speed = std::numeric_limits<double>::infinity();
  double creep_time = 0.0;  // s
  // True if the slip distance is the whole path of a pressed tip over the surface, creep in stick
  // included.
  bool counts_creep = false;
};

// The recipe of `fidelity: articulated`. The values belong together and were evaluated together, on
// onset, hold, steady slide and grip. Values that scale with the step are given relative to it, so
// that a smaller step refines the same model.
//   Normal: a critically damped contact in series with the slide, whose stiffness compensates for
//   the contact's (articulated.cc), so that f_n is k_n times the penetration of the undeformed tip
//   at any step.
//   Tangential: soft friction in the main solve (impratio) and Coulomb's in the noslip pass.
//   friction_time < dt leaves 1/(1 + 2/(impedance friction_time)) of a stuck tip's velocity per
//   step, so that the tip trails the drive by 0.2 steps.
//   Limits, measured: with a smaller impratio noslip ignores the normal force on a tilted pad,
//   which lifts off in a slide (1e-6: at 1 degree; 0.05: at 10 degrees); with a larger one slip
//   recruits normal force and tips chatter (0.2 with impedance 0.9 and friction_time 1: a held box
//   is dropped). As given, a slide is accurate to 1.5 % up to 3 degrees of tilt and to 8 % at 10
//   degrees, and tips chatter from some 100 mm/s on, earlier if pressed less. A tip that lifts off
//   may bounce for up to 3 steps. MuJoCo warns of none of this.
//   Tolerance: at 1e-6 the solvers stop before their first iteration and the pad floats, again
//   without a warning.
//   State rule: both thresholds lie in gaps of the measured values (slide, stop and turn at 0.2, 1
//   and 2 ms): noslip puts a slipping tip on the cone to 1e-15, and no slipping step was below 1e-5
//   m/s; a stuck tip creeps at less than 1e-6 m/s at steady drive, and faster only for a few steps
//   after a jump of the drive's velocity, then far inside the cone.
struct ArticulatedSettings {
  double tip_mass = 1e-5;      // kg, of one element's tip
  double tip_radius = 1e-4;    // m, of its spherical geom
  double damping_ratio = 0.3;  // of a free tip on its springs, all directions

  double contact_stiffness = 3.0;  // solref: -contact_stiffness/dt^2, with critical damping
  double impedance = 0.8;          // solimp
  double friction_time = 0.5;      // solreffriction: time constant over dt
  double impratio = 0.1;           // softness of the main solve's normal over its friction
  // Limit; usually 3 to 10 suffice. With a limit of 10 a box of 5 g is shaken loose.
  int noslip_iterations = 100;
  double tolerance = 1e-10;    // of main solver and noslip
  double longest_step = 2e-3;  // s
  // The path of a tip in a step. On longer ones tips bounce: at 0.2 mm a slide loses 1 % of its path,
  // from 0.3 mm on half of it.
  double longest_path = 1e-4;  // m
  // Tips that begin_on() pressed in come within 1e-9 of their loads in this many steps (measured: a
  // factor of 4 to 5 per step on tilted ones).
  int settling_steps = 30;
  // Largest share of an element's compliance that the bodies' inverse masses may contribute to its
  // contact.
  double compliance_share = 0.25;
  // Largest relative error of a normal force on the touched body that moves least easily.
  double force_share = 0.01;

  double cone_share = 1e-6;   // of the state rule
  double least_speed = 1e-6;  // m/s
};

// The recipe for steps of `dt` [s]: integrator discrete, elliptic cone, Newton. Throws
// std::invalid_argument unless 0 < dt <= longest_step.
PillarSettings articulated_pillars(const ArticulatedSettings& recipe, double dt);

// The settings of the scene's key `contact` (contact_entry in sim/scene/scene_values.h), for steps
// of `dt` > 0 [s]: slides as stiff as the elements, and MuJoCo's defaults for all values that the
// scene does not set. Friction of such a contact is a damper bounded by the cone, so that a loaded
// tip creeps. Its state rule:
//   slip      f_t = mu f_n and the tip moves (both to 1e-6, as in the recipe); or it moves over the
//             surface by more than 1 mm/s, now and in the mean of the last 10 ms
// By f_t = mu f_n alone, tips would stick that a soft contact lets slide below the cone for ever,
// as with MuJoCo's defaults. By any creep at all, every loaded tip would slip. And no threshold of
// the force would be exact, since on a ramp f_t reaches (1 - s) mu f_n too early by a share s.
// Where friction holds the cone decides exactly; where it does not, the tip's motion decides. The
// mean leaves out the motion of a stuck tip for a step or two when the drive jumps to its speed.
//
// No speed separates creep from slide in such a contact, so the slip distance does not depend on
// the state: it is the whole path of a pressed tip over the surface, as MuJoCo moves it.
//
// With pyramidal cones f_t is |f_x| + |f_y| along the contact's axes: mu f_n is MuJoCo's own bound
// of that.
PillarSettings user_pillars(const Parameters& contact, double dt);

// The settings for the scene's fidelity.
PillarSettings pillars_of_scene(const Scene& scene, double dt);

// Returns the number of steps to take before the run. `indented`: a tip starts inside the touched
// surface. Throws SceneValueError at contact.solref if that is so and it would take more than
// 100,000 steps to come to rest. Otherwise nothing moves in these steps, and so slow a contact gets
// one.
int steps_to_settle(const PillarSettings& settings, bool indented);

// Sets the model-wide options, the step included, and clears the flag autoreset.
void set_pillar_options(mjSpec* spec, const PillarSettings& settings);

// Returns MuJoCo's integrator of that name, one of those allowed in a scene.
mjtIntegrator integrator_named(std::string_view name);

}  // namespace slipbench
