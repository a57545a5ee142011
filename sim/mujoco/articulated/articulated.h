// Pads of `fidelity: articulated` and `mujoco_contact`: the elements as MuJoCo bodies, joints and
// contact pairs, and the conversion of their contact to a ContactFrame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <mujoco/mujoco.h>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/surface.h"
#include "sim/contact/unit_rules.h"
#include "sim/core/pose.h"
#include "sim/mujoco/articulated/pillar_settings.h"
#include "sim/scene/scene.h"

namespace slipbench {

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
  // Returns the first element whose spring is compressed by more than the height of a unit, if one
  // is: a real unit has no such compression.
  [[nodiscard]] std::optional<std::size_t> overcompressed(const mjModel* model, const mjData* data) const;
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
  void report_events(double begun, double time, double dt);
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
