// fidelity: articulated and mujoco_contact. A pad's elements as MuJoCo bodies, joints and contact pairs, and their contact read
// back as a ContactFrame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/core/contact_frame.h"
#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"
#include "sim/field/surface/surface.h"
#include "sim/field/unit_rules.h"
#include "sim/mujoco/articulated/pillar_settings.h"
#include "sim/scene/scene.h"

namespace slipbench {

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

  // See pillar_settings.h.
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
