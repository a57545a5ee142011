// The vectorised passes of a field step over a structure of arrays.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

#include "sim/api/contact_frame.h"
#include "sim/api/effect.h"
#include "sim/contact/columns.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"

namespace slipbench::kernel {

// Entries of a column processed at once (vectorise.h); columns are padded to a multiple of it.
inline constexpr std::size_t lanes = 4;

// A slip of a step shorter than this [m] is the rounding of coordinates (up to a hundred metres),
// not motion: an element at rest on its cone sticks. Slower motion is not lost: it accumulates in
// the stretch until it is longer.
inline constexpr double shortest_slip = 1e-13;

// The entries that a pass works on: `count` groups of `lanes`, which begin at `first`[0 .. count)
// or, if that is null, the first groups.
struct Groups {
  const std::uint32_t* first;
  std::size_t count;

  [[nodiscard]] std::size_t operator[](std::size_t k) const { return first != nullptr ? first[k] : k * lanes; }
};

// Returns the raw normal force [N] at a gap [m]: negative while separated, so that its zero is the
// instant of touch. `h`: history of a rheology. `Real`: double, or a vector.
template <class Real>
[[gnu::always_inline]] inline Real raw_normal_force(const Real& gap_now, const Real& k, const Real& h) {
  const Real none{};
  return k * -gap_now + (gap_now < 0.0 ? h : none);
}

// Pass 1 against the plane z = 0: contact points and gaps. `pose`: of the pad in the surface.
void plane_gap(const Columns& columns, const Pose& pose, std::size_t count);
// Opens the gaps of elements whose axis points away from the plane.
void turn_away(const Columns& columns, const Pose& pose, std::size_t count);

// Pass 1 against a box and a cylinder: contact points, gaps, normals and faces. `pose`: of the pad
// in the surface; `column`: length of an element behind its tip [m] (surface.h).
void meet_box(const Columns& columns, const Box& box, const Pose& pose, const Groups& groups, double column);
void meet_cylinder(const Columns& columns, const Cylinder& cylinder, const Pose& pose, const Groups& groups, double column);

// all_keep_faces(): true if Field::keep_energy() has nothing to do, which is nearly always so.
// any_touches(): true if an element touches that did not before, which is rare.
bool all_keep_faces(const Columns& columns, const Groups& groups);
bool any_touches(const Columns& columns, bool memory, std::size_t count);

// For columns with effects, on a surface other than a plane, without contact in the last step:
// returns true if nothing touches now either, and then leaves the columns bit-identical to
// return_map().
bool update_if_separated(const Columns& columns, std::size_t count);

// Between the passes, for effects: the positions of the tips (SurfaceEffect).
void place_tips(const Columns& columns, std::size_t count);

// Before pass 2, for a rate law: the columns trial and slide.
void find_trials(const Columns& columns, bool plane, std::size_t count);

// Pass 2: normal force, and return mapping onto the friction cone (field.h). `extended`: the
// columns beyond PlainColumns exist; then the rheology's history counts, and on a plane a
// sticking anchor stays bit-identical. Without them it stays up to rounding.
void return_map(const Columns& columns, bool plane, bool extended, const Groups& groups);

// Passes 1 and 2 at once, for springs on the plane.
void slide_on_plane(const Columns& columns, const Pose& pose, std::size_t count);

// Pass 2 up to the treatment of tips with mass: normal force and mu_s f_n.
void load_tips(const Columns& columns, std::size_t count);
// After the treatment: a tip that came to rest within the step has no slip velocity at its end.
void clear_ended_slip(const Columns& columns, std::size_t count);

// After the passes: forces, deflections and slip in the pad frame, or the first `vectors` of these.
// `rotation`: of the pad in the surface. `transmitted`: the tangential force that the pad feels.
void view_from_pad(const Columns& columns, const Eigen::Matrix3d& rotation, const VectorColumns& transmitted,
                   const Groups& groups, std::size_t vectors);

// Field::add_elements(). `to_pad`: rotation of the surface in the pad; `count`: of all elements.
void add_elements(const Columns& columns, const Eigen::Matrix3d& to_pad, const Groups& groups, double* depth,
                  const std::array<double*, 3>& shear, std::size_t count);

// Input of friction effects: depth and load, and with `speeds` the tangential velocity of the
// undeformed tips. `motion`: of the pad in the surface; null: the mean velocity of a step of
// `dt`; `dt` 0: no velocity. `memory`: there is a history of the rheology.
void rate(const Columns& columns, const Pose& pose, const Twist* motion, double dt, bool memory, bool speeds, std::size_t count);

// Sums over all springs; entries without contact hold nothing.
struct SpringSums {
  Eigen::Vector3d force_on_pad;  // N, in S
  double elastic;                // J
  double slip_loss;              // J, of the last step, with the force at its end
};
SpringSums sum_springs(const Columns& columns, const Groups& groups);

// Field::damped_wrench_on_pad(); `origin`: of the pad, in S.
Wrench damped_wrench_on_pad(const Columns& columns, const Eigen::Vector3d& origin, const Twist& motion, double tau,
                            const ConeEffect* cone, const Groups& groups);

// For an active set (active_set.h), after pass 1 of the `candidates`: writes the first elements of
// the active and of the idle groups to `active` and `idle`. Idle groups are left as return_map()
// would leave them.
struct Sorted {
  std::size_t active, idle;  // numbers of groups
  bool touches;              // an element touches that did not before
};
Sorted sort_groups(const Columns& columns, const Groups& candidates, std::uint32_t* active, std::uint32_t* idle);
// Sets groups without any touching element as sort_groups() leaves idle ones, in the columns of the
// last step too.
void reset_idle(const Columns& columns, const Groups& groups);

// True if a state has changed.
bool any_changes(const Columns& columns, const Groups& groups);
// True if an element, or an entry of the padding, penetrates by more than `depth` [m].
bool any_deeper(const Columns& columns, double depth, const Groups& groups);

}  // namespace slipbench::kernel
