// fidelity: articulated and mujoco_contact. A pad's elements as MuJoCo bodies, joints and contact
// pairs, and their contact converted to a ContactFrame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/surface.h"
#include "sim/contact/unit_rules.h"
#include "sim/core/pose.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Settings of a pad's elements as MuJoCo bodies with joints and sphere tips, and of the evaluation
// of their contact. Filled by the recipe of `fidelity: articulated` or, with `fidelity:
// mujoco_contact`, by the scene's `contact`.

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

// Inverse mass of the relative motion of an element's carrier and the touched bodies along its axis
// [1/kg]: for the bodies that move most and least easily. As in a step of the discrete integrator:
// with the inertia added by joints' dampers and springs.
struct InverseMass {
  double most = 0.0;
  double least = 0.0;
};

// Returns the longest step [s] for a pad on bodies with the given inverse masses. It is limited by
// the recipe; by compliance_share, beyond which the contact itself is too soft for a slide to
// compensate; and by force_share, since the slide, which compensates for one body only, makes the
// normal force on another wrong.
double longest_articulated_step(const PadLayout& layout, std::span<const InverseMass> inverse_mass,
                                const ArticulatedSettings& recipe);

// Returns MuJoCo's integrator of that name, one of those allowed in a scene.
mjtIntegrator integrator_named(std::string_view name);

// Throws SceneValueError for features that articulated pads lack: effects, a kinetic friction
// different from the static one, and `damping` above 1 ms: as joint damping it is part of the
// labels and not limited by the friction cone, so that a pillar drawn at a steady speed slips early
// by the dashpot's time.
void refuse_without_field(const Scene& scene);

// Adds one body with a spherical tip, two tangential slides and a normal slide to `carrier` for
// each element of the pad, in its order, and a contact pair of each tip with each of the geoms
// named in `touched`. Tips touch nothing else. The touched geoms should be declared before: the
// solver is several times slower otherwise. `inverse_mass`: per element; its `most` softens
// MuJoCo's contact, which a stiffer slide compensates; empty: none. Bodies, joints and geoms are
// named `<prefix>/<part>/<element>`. An element's dashpots become joint damping. Tips have no
// weight (gravcomp). Defaults of the model do not apply to them. Throws std::invalid_argument if a
// stiffness is not positive and finite, a dashpot is negative, an axis is not a unit vector, or
// mu_static != mu_kinetic: MuJoCo has one coefficient of friction.
void add_articulated_pad(mjSpec* spec, mjsBody* carrier, const Pose& pad_in_carrier, const PadLayout& layout,
                         std::span<const std::string> touched, Friction friction, const PillarSettings& settings,
                         const std::string& prefix, std::span<const InverseMass> inverse_mass = {});

// Puts a body with the free joint `joint` at `from`, moving so that it reaches `to` in a step of
// `dt` [s]. It is heavy, and its motion in the step is overwritten by the next call. (A mocap body
// would not do: it has no velocity, and friction against it is wrong.)
void drive_free_joint(const mjModel* model, mjData* data, int joint, const Pose& from, const Pose& to, double dt);

// Excludes the six degrees of freedom from `dof` on, those of a heavy driven body, from the mean
// inertia that scales MuJoCo's tolerances. Otherwise the solvers would stop before their first
// iteration, and bodies would sink into each other without a warning. `data` must have been through
// mj_forward().
void leave_out_of_scale(mjModel* model, const mjData* data, int dof);

// Reads the truth about a pad from a stepped mjData, into the same frame that ContactLabels fills.
//
// Forces are those that the solver found last: for the end of the step with the discrete
// integrator, which is implicit; those that acted through the step with the other one-stage
// integrators; those of the last stage with RK4. So is the slip velocity, J qvel of the contact,
// which except for RK4 is also the mean over the step: positions follow from it. The rule for an
// element's state:
//   detached  no contact of its tip presses
//   slip      f_t >= (1 - cone_share) mu f_n, and the tip moves over the surface faster than
//             least_speed; or it is faster than creep_speed, and so is its mean velocity,
//             exponential over creep_time
//   stick     otherwise
// f_t is in the cone's own norm, see user_pillars(); in the recipe the cone alone decides. A slide
// slower than least_speed counts as stick. The slip distance accumulates the tip's path over the
// surface in slip, and with counts_creep in stick too.
//
// Touch, onset, stop and detach are located inside the step by linear interpolation
// (articulated.cc). As with a Field, a unit's margin and contact plane are those on the surface
// with its greatest normal force.
class ArticulatedContact {
 public:
  // The pad that add_articulated_pad() added as `prefix`. Throws std::invalid_argument if the model
  // has no such pad.
  ArticulatedContact(const mjModel* model, const std::string& prefix, const PadLayout& layout, const PillarSettings& settings);

  // Presses tips that are inside the surface in along their axes: slide and contact share the depth
  // as in an indentation at rest, with no tangential strain. `data` must be as mj_makeData() leaves
  // it; with several surfaces the deepest counts. Returns true if any tip is inside.
  bool begin_on(const mjModel* model, mjData* data, const Surface& surface, const Pose& pad_in_surface) const;

  // See PillarSettings.
  [[nodiscard]] int steps_to_settle(bool indented) const { return slipbench::steps_to_settle(settings_, indented); }

  // Adapts the slides of `held`, a copy of the model in which nothing but tips can yield: there is
  // no inverse mass to compensate, and dashpots, which do nothing at rest, would only delay it.
  void suit_to_held(mjModel* held) const;

  // Moves the tips to the positions at which they press as in `settled`, data of `held`. Changes
  // only their positions.
  void take_tip_loads(const mjModel* model, mjData* data, const mjModel* held, const mjData* settled) const;

  // Reads the contact after mj_step() of `dt` that ended at `time` [s]. Must be called once after
  // every step, before anything else changes the data.
  const ContactFrame& read(const mjModel* model, const mjData* data, double time, double dt);

  // Treats the steps read so far as the settling of tips: the run begins at `time` [s], nothing has
  // slipped or rotated yet, and tips in contact start to touch at that instant, as with a Field.
  void begin_run(double time);

  [[nodiscard]] const ContactFrame& frame() const { return frame_; }
  // Returns the sum of the tips' normal forces, each from the contact with its greatest normal
  // force [N].
  [[nodiscard]] double normal_force() const;
  // The tips' bodies, by element.
  [[nodiscard]] const std::vector<int>& bodies() const { return bodies_; }

 private:
  // State of an element's tip in a step. Vectors in the pad frame P.
  struct Tip {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the pad
    // The contact with the greatest normal force:
    double normal_force = 0.0;  // N
    double limit = 0.0;         // mu f_n [N]
    double approach = 0.0;      // m/s, towards the surface, at the start of the step
    // of the surface
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    // N, on the pad
    Eigen::Vector3d tangential = Eigen::Vector3d::Zero();
    double drawn = 0.0;  // N, size of `tangential` in the norm of the contact's cone
    // m/s, of the tip over the surface, tangential
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    double fall = 0.0;  // N, decrease of the normal force in this step
    ElementState state = ElementState::detached;
  };

  void gather(const mjModel* model, const mjData* data);
  void average(double dt);
  [[nodiscard]] ElementState judge(std::size_t i) const;
  void report_events(double time, double dt);
  [[nodiscard]] double fraction_of_change(std::size_t i, double dt) const;
  void sum_units(const mjData* data);

  PadLayout layout_;
  PillarSettings settings_;
  std::vector<int> element_of_geom_;         // -1: not a tip
  std::vector<int> bodies_;                  // of an element's tip
  std::vector<int> qpos_;                    // address of an element's three joints
  std::vector<Eigen::Matrix3d> tip_in_pad_;  // rotation of its body in P
  std::vector<std::uint32_t> unit_of_element_;
  Eigen::Array3Xd undeformed_;                  // [3,N] m, mean of a unit's undeformed tips in P
  unit_rules::ContactPlane most_loaded_plane_;  // of the unit with the greatest normal force
  std::vector<Tip> tips_, before_;
  std::vector<double> path_;           // m
  std::vector<Eigen::Vector3d> mean_;  // m/s, of a tip's velocity; empty: the cone alone decides
  std::vector<double> constraint_velocity_;
  std::vector<unit_rules::UnitEvent> changes_;
  unit_rules::Count elements_;
  ContactFrame frame_;
};

}  // namespace slipbench
