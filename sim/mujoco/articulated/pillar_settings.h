// What MuJoCo is told of a pad's elements as bodies with joints and sphere tips, and how their contact is read. One description,
// which the recipe of `fidelity: articulated` fills and, with `fidelity: mujoco_contact`, the scene's `contact`.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include <mujoco/mujoco.h>

#include "sim/core/pad_layout.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Both ways to fill it say in their sources why a value is what it is.
struct PillarSettings {
  double dt = 0.0;  // s, of the steps that all of it is for

  // Options of the whole model.
  mjtIntegrator integrator = mjINT_DISCRETE;
  mjtCone cone = mjCONE_ELLIPTIC;
  mjtSolver solver = mjSOL_NEWTON;
  double impratio = 1.0;
  int iterations = 100;       // most, of the main solver
  int noslip_iterations = 0;  // most
  double tolerance = 0.0;     // of the main solver
  double noslip_tolerance = 0.0;
  std::optional<bool> refsafe;  // the flag; none: the model's own

  // Of an element's tip.
  double tip_mass = 0.0;       // kg
  double tip_radius = 0.0;     // m
  double damping_ratio = 0.0;  // of a free tip on its springs, all directions

  // Of its contact pair.
  std::array<mjtNum, mjNREF> solref{}, solreffriction{};
  std::array<mjtNum, mjNIMP> solimp{};

  // The slide along an element's axis is stiffer than the element by what MuJoCo's contact yields, see normal_slide() in
  // articulated.cc: the contact's stiffness over the effective mass in it, times dt^2. Infinite: slides are as stiff as the
  // elements.
  double contact_ratio = std::numeric_limits<double>::infinity();

  // Whether the mean inertia, by which the solvers' tolerances are scaled, is that of a model with a prescribed pad's heavy
  // carrier in it.
  bool carrier_in_scale = false;

  double settling_steps = 0.0;  // whole; in which indented tips come to rest before the run, see steps_to_settle()

  // The state rule, see ArticulatedContact.
  double cone_share = 0.0;
  double least_speed = 0.0;                                      // m/s
  double creep_speed = std::numeric_limits<double>::infinity();  // m/s; infinite: what the cone says is enough
  double creep_time = 0.0;                                       // s
  // Whether the slip distance is all of a pressed tip's way over the surface, creep that reads as stick included.
  bool counts_creep = false;
};

// The recipe of `fidelity: articulated`. It is one: the values go together and were judged together, on onset, hold, steady slide
// and grip. What scales with the step is given over it, so that a smaller step is a finer model and not another one.
//   Normal: a critically damped contact in series with the slide, whose stiffness makes up for the contact's (articulated.cc), so
//   that f_n is k_n times the penetration of the undeformed tip whatever the step.
//   Tangential: soft friction in the main solve (impratio) and Coulomb's in the noslip pass. friction_time < dt takes a stuck
//   tip's velocity away but for 1/(1 + 2/(impedance friction_time)) a step, so that it trails the drive by 0.2 steps.
//   Limits, measured: with a smaller impratio noslip does not know the normal force on a tilted pad, which lifts off in a slide
//   (1e-6: at 1 degree; 0.05: at 10 degrees); with a larger one slip recruits normal force and tips chatter (0.2 with impedance
//   0.9 and friction_time 1: a held box is dropped). As given, a slide is right to 1.5 % up to 3 degrees of tilt and to 8 % at 10
//   degrees, and tips chatter from some 100 mm/s on, the sooner the less they are pressed. A tip that lifts off may bounce for up
//   to 3 steps. No warning of MuJoCo tells any of this.
//   Tolerance: at 1e-6 the solvers stop before they have done anything and the pad floats, again without a warning.
//   State rule: both thresholds lie in gaps of what was measured (slide, stop and turn at 0.2, 1 and 2 ms): noslip puts a
//   slipping tip on the cone to 1e-15, and left no slipping step under 1e-5 m/s; a stuck tip creeps at less than 1e-6 m/s at
//   steady drive, and faster only for a few steps after a jump of the drive's velocity, then far inside the cone.
struct ArticulatedSettings {
  double tip_mass = 1e-5;      // kg, of one element's tip
  double tip_radius = 1e-4;    // m, of its spherical geom
  double damping_ratio = 0.3;  // of a free tip on its springs, all directions

  double contact_stiffness = 3.0;  // solref: -contact_stiffness/dt^2, with critical damping
  double impedance = 0.8;          // solimp
  double friction_time = 0.5;      // solreffriction: time constant over dt
  double impratio = 0.1;           // softness of the main solve's normal over its friction
  int noslip_iterations = 100;     // most; usually 3 to 10 do. With 10 at most a box of 5 g is shaken loose
  double tolerance = 1e-10;        // of main solver and noslip
  double longest_step = 2e-3;      // s
  // Tips that begin_on() pressed in come within 1e-9 of their loads in these (measured: a factor of 4 to 5 a step on tilted
  // ones).
  int settling_steps = 30;
  double compliance_share = 0.25;  // of an element's compliance, that the bodies' inverse masses may make its contact
  double force_share = 0.01;       // by which a normal force may be wrong on the body that moves least easily of those touched

  double cone_share = 1e-6;   // of the state rule
  double least_speed = 1e-6;  // m/s
};

// The recipe for steps of `dt` [s]: integrator discrete, elliptic cone, Newton. Throws std::invalid_argument unless 0 < dt <=
// longest_step.
PillarSettings articulated_pillars(const ArticulatedSettings& recipe, double dt);

// What the scene's key `contact` (contact_entry in sim/scene/scene_values.h) says, for steps of `dt` > 0 [s]: slides as stiff as
// the elements, and MuJoCo's defaults for all that it does not say. The state rule for such a contact, whose friction is a damper
// that the cone bounds, so that a loaded tip creeps:
//   slip      f_t = mu f_n and the tip moves (both to 1e-6, as in the recipe); or it moves over the surface by more than 1 mm/s,
//             now and in the mean of the last 10 ms
// Why so: by f_t = mu f_n alone tips would stick that a soft contact lets slide under the cone for ever, as MuJoCo's defaults do. By
// any creep at all every loaded tip would slip. And no threshold of the force would be exact, for on a ramp f_t comes to
// (1 - s) mu f_n by a share s too early. Where friction holds the cone decides, to the digit, and where it does not, the tip's
// motion. The mean leaves out how a stuck tip gives way for a step or two when the drive jumps to its speed.
// No speed parts creep from slide in such a contact, so the slip distance asks for no state: it is all of a pressed tip's way over the
// surface, as MuJoCo moves it.
// With pyramidal cones f_t is |f_x| + |f_y| along the contact's axes: mu f_n is MuJoCo's own bound of that.
PillarSettings user_pillars(const Parameters& contact, double dt);

// As the scene's fidelity says.
PillarSettings pillars_of_scene(const Scene& scene, double dt);

// How many steps to take before the run. `indented`: a tip begins inside what it touches. Throws SceneValueError at contact.solref
// where one does and would take more than 100,000 of them to come to rest. Where none does nothing moves in them, and so long a contact
// gets one.
int steps_to_settle(const PillarSettings& settings, bool indented);

// Sets the model-wide options, the step among them, and takes the flag autoreset off.
void set_pillar_options(mjSpec* spec, const PillarSettings& settings);

// How easily an element's carrier and what it touches move apart along its axis [1/kg], of the touched bodies that move the most
// and the least easily. In a step as the discrete integrator sees them: with what joints' dampers and springs add to inertia.
struct InverseMass {
  double most = 0.0;
  double least = 0.0;
};

// The longest step [s] for a pad on bodies with the given inverse masses: the recipe's, or that at which the contact itself is so
// soft, by compliance_share, that a slide could no longer make up for it, or that at which the slide, which can do so for one
// body only, makes the normal force on another wrong by force_share.
double longest_articulated_step(const PadLayout& layout, std::span<const InverseMass> inverse_mass,
                                const ArticulatedSettings& recipe);

// MuJoCo's integrator of that name, one of those that a scene may write.
mjtIntegrator integrator_named(std::string_view name);

}  // namespace slipbench
