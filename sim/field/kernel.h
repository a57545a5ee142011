// The vectorised passes of a field step over a structure of arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "sim/core/contact_frame.h"
#include "sim/core/pose.h"
#include "sim/field/effect.h"
#include "sim/field/surface/surface.h"

namespace slipbench::kernel {

// Columns of the structure of arrays; one entry an element, 32-byte aligned, a multiple of `lanes` long. Three in a row form a vector.
// "before" is the value at the end of the step before. In the surface frame S unless said otherwise.
// clang-format off
enum Column : std::size_t {
  tip_x, tip_y, tip_z, axis_x, axis_y, axis_z,              // pad frame P [m], [1]
  k_normal, k_tangential, compliance,                       // [N/m], [N/m], 1/k_tangential [m/N]
  mu_static, mu_kinetic,
  contact_x, contact_y, contact_z, contact_before_x, contact_before_y, contact_before_z,  // [m]
  normal_x, normal_y, normal_z,                             // of the surface
  gap, gap_before,                                          // [m], negative: penetration
  f_normal, f_normal_before,                                   // raw normal force [N], negative while apart
  limit, limit_before,                                      // mu_s f_n [N]
  anchor_x, anchor_y, anchor_z,                             // [m]
  slip_x, slip_y, slip_z,                                   // of the tip over the surface in the last step [m]
  force_x, force_y, force_z, force_before_x, force_before_y, force_before_z,  // tangential, of the pad on the surface [N]
  mode, mode_before,                                        // 0 detached, 1 stick, 2 slip; a double so that the loops vectorise
  path,                                                     // slipped since the start [m]
  faces, faces_before,                                      // SurfacePoint::faces; 0 on a plane
  depth_offset,                                             // s of field.h: depth without normal force [m]
  pad_force_x, pad_force_y, pad_force_z,                    // of the surface on the pad, in P [N]
  deflection_x, deflection_y, deflection_z,                 // deformed tip minus undeformed tip, in P [m]
  pad_slip_x, pad_slip_y, pad_slip_z,                       // slip in P [m]
  plain_columns,
  // only where effects or dashpots ask for them; without them the first two are the springs themselves
  k_normal_spring = plain_columns, k_tangential_spring, mu_static_surface, mu_kinetic_surface,  // before effects
  h_normal, h_x, h_y, h_z,                                  // history of the rheology: f = k u + h [N]; without one h_x is null
  velocity_x, velocity_y, velocity_z, depth, load, stretch_x, stretch_y, stretch_z,     // what effects look at
  place_x, place_y, place_z,                                // where the tip meets effects (SurfaceEffect) [m]
  transmitted_x, transmitted_y, transmitted_z,                                   // of spring and dashpot on a tip with mass [N]
  trial, slide,                                             // of the trial: size of the force, mu_k f_n (mu_s f_n where columns lean) [N]
  all_columns
};
// clang-format on
using Columns = std::array<double*, all_columns>;

// Entries of a column that are worked on at once (vectorise.h); columns are padded to a multiple of it.
inline constexpr std::size_t lanes = 4;

// A slip of a step [m] shorter than this is the rounding of coordinates (up to a hundred metres), not motion: an element at rest on its
// cone sticks. Slower motion is not lost; the stretch gathers it until it is longer.
inline constexpr double shortest_slip = 1e-13;

// Which entries a pass works on: `count` groups of `lanes`, those that begin at `first`[0 .. count), or, where that is null, the first ones.
struct Groups {
  const std::uint32_t* first;
  std::size_t count;

  [[nodiscard]] std::size_t operator[](std::size_t k) const { return first != nullptr ? first[k] : k * lanes; }
};

// Raw normal force [N] at a gap [m]: negative while apart, so that its zero is the instant of touch. `h` is the history of a rheology.
// `Real`: double, or several at once.
template <class Real>
[[gnu::always_inline]] inline Real raw_normal_force(const Real& gap_now, const Real& k, const Real& h) {
  const Real none{};
  return k * -gap_now + (gap_now < 0.0 ? h : none);
}

// Pass 1 against the plane z = 0: contact points and gaps. `pose`: of the pad in the surface.
void plane_gap(const Columns& columns, const Pose& pose, std::size_t count);
// Opens the gaps of elements whose axis does not look at the plane.
void turn_away(const Columns& columns, const Pose& pose, std::size_t count);

// Pass 1 against a box and a cylinder: contact points, gaps, normals and faces. `pose`: of the pad in the surface; `column`: length of an
// element behind its tip [m] (surface.h).
void meet_box(const Columns& columns, const Box& box, const Pose& pose, const Groups& groups, double column);
void meet_cylinder(const Columns& columns, const Cylinder& cylinder, const Pose& pose, const Groups& groups, double column);

// Whether nothing is for Field::keep_energy() to do, and whether an element touches that did not before: nearly always, and nearly never.
bool all_keep_faces(const Columns& columns, const Groups& groups);
bool any_touches(const Columns& columns, bool memory, std::size_t count);

// Of columns with effects, on no plane, of which nothing touched before: whether nothing touches now, and then, to the bit, what map() makes of that.
bool stay_apart(const Columns& columns, std::size_t count);

// Between the passes, for effects: the places of the tips (SurfaceEffect).
void place_tips(const Columns& columns, std::size_t count);

// Before pass 2, for a rate law: the columns trial and slide.
void find_trials(const Columns& columns, bool plane, std::size_t count);

// Pass 2: normal force, and return mapping onto the friction cone (field.h). `extended`: the columns from plain_columns on are there; then the
// rheology's history counts, and on a plane an anchor that sticks stays to the bit. Without them it does up to rounding.
void map(const Columns& columns, bool plane, bool extended, const Groups& groups);

// Passes 1 and 2 at once, for springs on the plane.
void slide_on_plane(const Columns& columns, const Pose& pose, std::size_t count);

// Pass 2 up to where tips with mass take over: normal force and mu_s f_n.
void load_tips(const Columns& columns, std::size_t count);

// After the passes: forces, deflections and slip as the pad sees them, or the first `vectors` of these. `rotation`: of the pad in the surface.
// `transmitted`: the tangential force that the pad feels.
void view_from_pad(const Columns& columns, const Eigen::Matrix3d& rotation, Column transmitted, const Groups& groups,
                   std::size_t vectors);

// Field::add_elements(). `to_pad`: rotation of the surface in the pad; `count`: of all elements.
void add_elements(const Columns& columns, const Eigen::Matrix3d& to_pad, const Groups& groups, double* depth,
                  const std::array<double*, 3>& shear, std::size_t count);

// What friction effects look at: depth and load, and if `speeds` tangential velocity of the undeformed tips. `motion`: of the pad in the surface,
// null for the mean one of a step of `dt`, 0: none. `memory`: there is a history of the rheology.
void rate(const Columns& columns, const Pose& pose, const Twist* motion, double dt, bool memory, bool speeds, std::size_t count);

// What all springs together do and hold; entries that do not touch hold nothing.
struct SpringSums {
  Eigen::Vector3d force_on_pad;  // N, in S
  double elastic;                // J
  double slip_loss;              // J, of the last step, with the force at its end
};
SpringSums sum_springs(const Columns& columns, const Groups& groups);

// Field::damped_wrench_on_pad(); `origin`: of the pad, in S.
Wrench damped_wrench_on_pad(const Columns& columns, const Eigen::Vector3d& origin, const Twist& motion, double tau,
                            const ConeEffect* cone, const Groups& groups);

// For an active set (active_set.h), after pass 1 of the `candidates`: writes to `active` and `idle` where those groups begin that are. Idle ones
// are left as map() would leave them.
struct Sorted {
  std::size_t active, idle;  // how many they are
  bool touches;              // an element touches that did not before
};
Sorted sort_groups(const Columns& columns, const Groups& candidates, std::uint32_t* active, std::uint32_t* idle);
// Of groups of which no element touches: what sort_groups() leaves of idle ones, in the columns of the step before too.
void rest(const Columns& columns, const Groups& groups);

// Whether a state is another than before.
bool any_changes(const Columns& columns, const Groups& groups);

// What the elements of a unit add up to, each column one after the other from the first element on.
struct UnitSum {
  static constexpr std::size_t vector_columns = 12;
  // The columns that are added up: `vectors` as they come, and what the others say.
  struct Summed {
    std::array<const double*, vector_columns> vectors;
    const double *path, *limit, *f_normal, *mode;
  };
  std::array<double, vector_columns> vectors;
  double path, limit;
  double normal_force;        // N, of the elements that touch
  double touching, slipping;  // elements
};
UnitSum sum_unit(const UnitSum::Summed& columns, std::size_t first, std::size_t count);

// What labels are made of, an entry a unit: sums over its elements, vectors by component.
struct UnitColumns {
  std::array<const double*, 3> force, deflection, slip;  // columns pad_force_x, deflection_x and pad_slip_x
  std::array<const double*, 3> tangential, normal;       // columns force_x and normal_x
  const double *path, *limit;
  const double* touching;  // 0: no element of the unit touches
  const double* share;     // 1/elements of the unit
};

// Fills the columns force of a frame, and displacement, from `first` to before `end` of its units: what is FramePart::felt.
void label_felt(const UnitColumns& units, std::size_t first, std::size_t end, bool displacement, ContactFrame& frame);
// Fills the columns from `first` to before `end` of `frame` (contact_frame.h) with what its units are given in: all but their states.
// `turn`: into the contact plane, null where that is the pad's own; `rate`: 1/step [1/s]; `cone`: in place of the circular one, or null.
void label_units(const UnitColumns& units, const Eigen::Matrix3d* turn, double rate, const ConeEffect* cone, std::size_t first,
                 std::size_t end, ContactFrame& frame);
// The same of groups of units of one element, each of which meets a normal of its own. `to_pad`: rotation of the surface in the pad.
void label_groups(const UnitColumns& units, const Eigen::Matrix3d& to_pad, double rate, const Groups& groups, std::size_t count,
                  ContactFrame& frame);
// The same, or what of it is felt, of `count` >= lanes units of one element each that meet a plane whose normal is the pad's Z to the bit, without a
// view_from_pad() before, and their states. `rotation`, `transmitted`: as there.
void label_level_elements(const Columns& columns, const Eigen::Matrix3d& rotation, Column transmitted, double rate,
                          std::size_t count, FramePart part, ContactFrame& frame);

}  // namespace slipbench::kernel
