// fidelity: articulated and mujoco_contact. A pad's elements as MuJoCo bodies, joints and contact pairs, and their contact read
// back as a ContactFrame.
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

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/contact_labels.h"
#include "sim/field/field.h"
#include "sim/field/surface/surface.h"
#include "sim/field/unit_rules.h"
#include "sim/scene/scene.h"

namespace slipbench {

// What MuJoCo is told of a pad's elements as bodies with joints and sphere tips, and how their contact is read. One description,
// which the recipe of `fidelity: articulated` fills and, with `fidelity: mujoco_contact`, the scene's `contact`.

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

// Throws SceneValueError for what articulated pads cannot have: effects, a kinetic friction that is not the static one, and
// `damping` above 1 ms: as joint damping it is in the labels and not held in the friction cone, so that a pillar drawn at a steady
// speed slips early by the dashpot's time.
void refuse_without_field(const Scene& scene);

// Adds one body with a spherical tip, two tangential slides and a normal slide to `carrier` for each element of the pad, in its
// order, and a contact pair of each tip with each of the geoms named in `touched`. Tips touch nothing else. The touched geoms
// should be declared before: the solver is several times slower the other way round. `inverse_mass`: of each element; the most is
// what MuJoCo's contact gets softer by and the slide, where it makes up for that, must be stiffer for; empty: none. Bodies,
// joints and geoms are named `<prefix>/<part>/<element>`. An element's dashpots become joint damping. Tips carry no weight
// (gravcomp). Defaults of the model do not reach them.
// Throws std::invalid_argument when a stiffness is not positive and finite, a dashpot is negative, an axis is not a unit vector, or
// mu_static != mu_kinetic: MuJoCo knows one coefficient of friction.
void add_articulated_pad(mjSpec* spec, mjsBody* carrier, const Pose& pad_in_carrier, const PadLayout& layout,
                         std::span<const std::string> touched, Friction friction, const PillarSettings& settings,
                         const std::string& prefix, std::span<const InverseMass> inverse_mass = {});

// Puts a body with the free joint `joint` at `from`, moving so that it reaches `to` in a step of `dt` [s]. It is heavy and what
// becomes of it in the step is not kept. (A mocap body would not do: it has no velocity, and friction against it is wrong.)
void drive_free_joint(const mjModel* model, mjData* data, int joint, const Pose& from, const Pose& to, double dt);

// Takes the six degrees of freedom from `dof` on, those of a heavy body that is driven, out of the mean inertia by which MuJoCo's
// solvers measure what is small: else they would stop before they have begun, and bodies would sink into each other without a
// warning. `data`: has been through mj_forward().
void leave_out_of_scale(mjModel* model, const mjData* data, int dof);

// Reads the truth about a pad out of a stepped mjData, into the same frame that ContactLabels fills.
// Forces are those that the solver found last: for the end of the step with the discrete integrator, which is implicit; the ones
// that acted through the step with the other one-stage integrators; those of the last stage with RK4. So is the slip velocity, J
// qvel of the contact, which but for RK4 is also the mean over the step: positions follow from it. The rule for an element's
// state:
//   detached  no contact of its tip presses
//   slip      f_t >= (1 - cone_share) mu f_n, and the tip moves over the surface faster than least_speed; or it is faster than
//             creep_speed, and so is its mean velocity, exponential over creep_time
//   stick     otherwise
// f_t in the cone's own norm, see user_pillars(); in the recipe the cone is all. A slide slower than least_speed reads as stick.
// The slip distance adds up the tip's way over the surface in slip, and with counts_creep in stick too.
// Touch, onset, stop and detach are located inside the step along straight lines (articulated.cc). Like that of a Field, a
// unit's margin and contact plane are those on the surface where its normal force is greatest.
class ArticulatedContact {
 public:
  // The pad that add_articulated_pad() added as `prefix`. Throws std::invalid_argument where the model has no such pad.
  ArticulatedContact(const mjModel* model, const std::string& prefix, const PadLayout& layout, const PillarSettings& settings);

  // Presses the tips in that stand inside the surface, each along its axis: slide and contact share the depth as in an indentation that
  // has come to rest, sideways nothing is strained. For data as mj_makeData() leaves it; of several surfaces the deepest counts.
  // Returns whether there are any.
  bool begin_on(const mjModel* model, mjData* data, const Surface& surface, const Pose& pad_in_surface) const;

  // See PillarSettings.
  [[nodiscard]] int steps_to_settle(bool indented) const { return slipbench::steps_to_settle(settings_, indented); }

  // Makes of `held`, a copy of the model in which nothing but tips can give way, one whose slides suit that: there is no inverse
  // mass to make up for, and dashpots, which at rest do nothing, would only delay the rest.
  void suit_to_held(mjModel* held) const;

  // Puts the tips where they press as they do in `settled`, data of `held`. Only their positions change.
  void take_tip_loads(const mjModel* model, mjData* data, const mjModel* held, const mjData* settled) const;

  // Reads the contact after mj_step() of `dt` that ended at `time` [s]; to be called once after every step, before anything else
  // changes the data.
  const ContactFrame& read(const mjModel* model, const mjData* data, double time, double dt);

  // Takes the steps read so far for the settling of tips: the run begins at `time` [s], nothing has slipped or turned yet, and what
  // touches begins to at that instant, as on a Field.
  void begin_run(double time);

  [[nodiscard]] const ContactFrame& frame() const { return frame_; }
  // The sum of the normal forces on the tips, each of the contact with the greatest normal force [N].
  [[nodiscard]] double normal_force() const;
  // The tips' bodies, by element.
  [[nodiscard]] const std::vector<int>& bodies() const { return bodies_; }

 private:
  // What one element's tip did in a step. Vectors in the pad frame P.
  struct Tip {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the pad
    // Of the contact with the greatest normal force:
    double normal_force = 0.0;                             // N
    double limit = 0.0;                                    // mu f_n [N]
    double approach = 0.0;                                 // m/s, at which it came to the surface, at the start of the step
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // of the surface
    Eigen::Vector3d tangential = Eigen::Vector3d::Zero();  // N, on the pad
    double drawn = 0.0;                                    // N, the same in the norm of the contact's cone
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();    // m/s, of the tip over the surface, tangential
    double fall = 0.0;                                     // N, by which the normal force fell in this step
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
  std::vector<Eigen::Vector3d> mean_;  // m/s, of a tip's velocity; empty: the cone is all
  std::vector<double> constraint_velocity_;
  std::vector<unit_rules::UnitEvent> changes_;
  unit_rules::Count elements_;
  ContactFrame frame_;
};

}  // namespace slipbench
