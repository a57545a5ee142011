// fidelity: articulated. A pad's elements as MuJoCo bodies, joints and contact pairs, and their contact read back as a
// ContactFrame.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"
#include "sim/field/surface.h"
#include "sim/field/unit_rules.h"
#include "sim/scene/scene.h"

namespace slipbench {

// The recipe. It is one: the values go together and were judged together, on onset, hold, steady slide and grip. What scales with
// the step is given over it, so that a smaller step is a finer model and not another one.
//   Normal: a critically damped contact in series with the slide, whose stiffness makes up for the contact's (articulated.cc), so
//   that f_n is k_n times the penetration of the undeformed tip whatever the step.
//   Tangential: soft friction in the main solve (impratio) and Coulomb's in the noslip pass. friction_time < dt takes a stuck tip's
//   velocity away but for 1/(1 + 2/(impedance friction_time)) a step, so that it trails the drive by 0.2 steps.
//   Limits, measured: with a smaller impratio noslip does not know the normal force on a tilted pad, which lifts off in a slide
//   (1e-6: at 1 degree; 0.05: at 10 degrees); with a larger one slip recruits normal force and tips chatter (0.2 with impedance 0.9
//   and friction_time 1: a held box is dropped). As given, a slide is right to 1.5 % up to 3 degrees of tilt and to 8 % at 10
//   degrees, and tips chatter from some 100 mm/s on, the sooner the less they are pressed. A tip that lifts off may bounce for up
//   to 3 steps. No warning of MuJoCo tells any of this.
//   Tolerance: at 1e-6 the solvers stop before they have done anything and the pad floats, again without a warning.
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
  // Tips that begin_on() pressed in come within 1e-9 of their loads in these (measured: a factor of 4 to 5 a step on tilted ones).
  int settling_steps = 30;
  double compliance_share = 0.25;  // of an element's compliance, that the bodies' inverse masses may make its contact
  double press_share = 0.01;       // by which a press may be wrong on the body that moves least easily of those touched

  // The state rule, see ArticulatedContact.
  double cone_share = 1e-6;
  double creep_speed = 1e-6;  // m/s
};

// Throws SceneValueError for what articulated pads cannot have: effects, a kinetic friction that is not the static one, and
// `damping` above 1 ms: as joint damping it is in the labels and not held in the friction cone, so that a pillar drawn at a steady
// speed slips early by the dashpot's time.
void refuse_without_field(const Scene& scene);

// Sets the recipe's model-wide options for steps of `dt` [s]: integrator discrete, elliptic cone, Newton, impratio, noslip, the
// solvers' tolerances and their bounds of iterations, and the flag autoreset off. Throws std::invalid_argument unless 0 < dt <=
// longest_step.
void set_articulated_options(mjSpec* spec, const ArticulatedSettings& settings, double dt);

// How easily an element's carrier and what it touches move apart along its axis [1/kg], of the touched bodies that move the most
// and the least easily. In a step as the discrete integrator sees them: with what joints' dampers and springs add to inertia.
struct InverseMass {
  double most = 0.0;
  double least = 0.0;
};

// Adds one body with a spherical tip, two tangential slides and a normal slide to `carrier` for each element of the pad, in its
// order, and a contact pair of each tip with each of the geoms named in `touched`. Tips touch nothing else. The touched geoms
// should be declared before: the solver is several times slower the other way round. `inverse_mass`: of each element; the most is
// what MuJoCo's contact gets softer by and the slide must be stiffer for; empty: none. Bodies, joints and geoms are named
// `<prefix>/<part>/<element>`. An element's dashpots become joint damping. Tips carry no weight (gravcomp). Defaults of the model
// do not reach them.
// Throws std::invalid_argument when a stiffness is not positive and finite, a dashpot is negative, an axis is not a unit vector, or
// mu_static != mu_kinetic: MuJoCo knows one coefficient of friction.
void add_articulated_pad(mjSpec* spec, mjsBody* carrier, const Pose& pad_in_carrier, const PadLayout& layout,
                         std::span<const std::string> touched, Friction friction, const ArticulatedSettings& settings, double dt,
                         const std::string& prefix, std::span<const InverseMass> inverse_mass = {});

// The longest step [s] for a pad on bodies with the given inverse masses: the recipe's, or that at which the contact itself is so
// soft, by compliance_share, that a slide could no longer make up for it, or that at which the slide, which can do so for one body
// only, makes a press on another wrong by press_share.
double longest_articulated_step(const PadLayout& layout, std::span<const InverseMass> inverse_mass,
                                const ArticulatedSettings& settings);

// Puts a body with the free joint `joint` at `from`, moving so that it reaches `to` in a step of `dt` [s]. It is heavy and what
// becomes of it in the step is not kept. (A mocap body would not do: it has no velocity, and friction against it is wrong.)
void drive_free_joint(const mjModel* model, mjData* data, int joint, const Pose& from, const Pose& to, double dt);

// Reads the truth about a pad out of a stepped mjData, into the same frame that ContactLabels fills.
// Forces are those that the solver found for the end of the step (the discrete integrator is implicit), and so is the slip
// velocity, J qvel of the contact, which is also the mean over the step: positions follow from it. The rule for an element's state:
//   detached  no contact of its tip presses
//   slip      f_t >= (1 - cone_share) mu f_n, and the tip moves over the surface faster than creep_speed
//   stick     otherwise
// Both thresholds lie in gaps of what was measured (slide, stop and turn at 0.2, 1 and 2 ms): noslip puts a slipping tip on the
// cone to 1e-15, and left no slipping step under 1e-5 m/s; a stuck tip creeps at less than 1e-6 m/s at steady drive, and faster
// only for a few steps after a jump of the drive's velocity, then far inside the cone. A slide slower than creep_speed reads as
// stick. Touch, onset, stop and detach are located inside the step along straight lines (articulated.cc). Like that of a Field, a
// unit's margin and contact plane are those on the surface that presses it hardest.
class ArticulatedContact {
 public:
  // The pad that add_articulated_pad() added as `prefix`. Throws std::invalid_argument where the model has no such pad.
  ArticulatedContact(const mjModel* model, const std::string& prefix, const PadLayout& layout,
                     const ArticulatedSettings& settings);

  // Presses the tips in that stand inside the surface, each along its axis: slide and contact share the depth as in a press that
  // has come to rest, sideways nothing is strained. For data as mj_makeData() leaves it; of several surfaces the deepest counts.
  void begin_on(const mjModel* model, mjData* data, const Surface& surface, const Pose& pad_in_surface) const;

  // Makes of `held`, a copy of the model in which nothing but tips can give way, one whose slides suit that: there is no inverse
  // mass to make up for, and dashpots, which at rest do nothing, would only delay the rest.
  void suit_to_held(mjModel* held) const;

  // Puts the tips where they press as they do in `settled`, data of `held`. Only their positions change.
  void take_presses(const mjModel* model, mjData* data, const mjModel* held, const mjData* settled) const;

  // Reads the contact after mj_step() of `dt` that ended at `time` [s]; to be called once after every step, before anything else
  // changes the data.
  const ContactFrame& read(const mjModel* model, const mjData* data, double time, double dt);

  // Takes the steps read so far for the settling of tips: the run begins at `time` [s], nothing has slipped or turned yet, and what
  // touches begins to at that instant, as on a Field.
  void begin_run(double time);

  [[nodiscard]] const ContactFrame& frame() const { return frame_; }
  // The tips' bodies, by element.
  [[nodiscard]] const std::vector<int>& bodies() const { return bodies_; }

 private:
  // What one element's tip did in a step. Vectors in the pad frame P.
  struct Tip {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N, on the pad
    // Of the contact that presses hardest:
    double press = 0.0;                                    // N
    double limit = 0.0;                                    // mu f_n [N]
    double approach = 0.0;                                 // m/s, at which it came to the surface, at the start of the step
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // of the surface
    Eigen::Vector3d tangential = Eigen::Vector3d::Zero();  // N, on the pad
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();    // m/s, of the tip over the surface, tangential
    double fall = 0.0;                                     // N, by which the press fell in this step
    ElementState state = ElementState::detached;
  };

  void gather(const mjModel* model, const mjData* data);
  [[nodiscard]] ElementState judge(const Tip& tip) const;
  void report_events(double time, double dt);
  [[nodiscard]] double fraction_of_change(std::size_t i, double dt) const;
  void sum_units(const mjData* data);

  PadLayout layout_;
  ArticulatedSettings settings_;
  std::vector<int> element_of_geom_;         // -1: not a tip
  std::vector<int> bodies_;                  // of an element's tip
  std::vector<int> qpos_;                    // address of an element's three joints
  std::vector<Eigen::Matrix3d> tip_in_pad_;  // rotation of its body in P
  std::vector<std::uint32_t> unit_of_element_;
  Eigen::Array3Xd undeformed_;              // [3,N] m, mean of a unit's undeformed tips in P
  unit_rules::ContactPlane hardest_plane_;  // of the unit that presses hardest
  std::vector<Tip> tips_, before_;
  std::vector<double> path_;  // m
  std::vector<double> constraint_velocity_;
  std::vector<unit_rules::UnitEvent> changes_;
  unit_rules::Count elements_;
  ContactFrame frame_;
};

}  // namespace slipbench
