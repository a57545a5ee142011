// The step of a pad that is one elastic body (SkinEffect).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/columns.h"
#include "sim/core/pose.h"

namespace slipbench {

// Columns of a skin, of the padded length of those of its field. "Frame": the element's own, with
// its axis as z.
struct SkinColumns {
  // A vector across the element's axis or, where stated, in the tangent plane.
  struct Across {
    double *x, *y;
  };
  kernel::VectorColumns x_axis, y_axis, z_axis;  // of the frame, in P
  kernel::VectorColumns tip;                     // undeformed, in the frame [m]
  Across loaded_tip;                             // position of the loaded tip, in the frame [m]
  double* axial_gap;                             // [m]
  double* cosine;                                // between z and the normal
  Across normal;                                 // components of the normal
  Across target;                                 // g of sim/effects/skin/elastic_contact.h, in the tangent plane [m]
  double* cap;                                   // its L [N]
  // SkinEffect::Solution
  double *pressure, *sunk;
  Across shear, shift;
  double* slides;
};

// Takes the steps of a field of elements that share one elastic body. It needs three things that a
// field of springs does not need:
// - The contact is evaluated where the loaded skin is: for a touching tip at its anchor, as the
//   last step has left it. So a stuck patch feels no change of gap while the pad moves along, and a
//   tip that begins to slip, or stops, does not jump to another position. For a slipping tip the
//   contact lags by the slip of one step.
// - A gap is measured along the element's axis, gap/cos of the angle between axis and normal, as
//   the skin yields. A force p along the axis is p/cos along the normal.
// - Displacements and forces in the tangent plane are given by the element's x and y, after the
//   shortest rotation of its z onto the normal.
//
// A step calls rests() and, if that is false, place_tips(), press() and shear(), in this order.
// `columns`: of the field; `pose`: of the pad in the surface.
class SkinStepper {
 public:
  // `effect` must outlive the stepper. Replaces the springs of `layout` and of `columns` by the
  // skin's stiffness.
  SkinStepper(SkinEffect& effect, PadLayout& layout, const kernel::Columns& columns);
  SkinStepper(SkinStepper&&) = default;
  SkinStepper& operator=(SkinStepper&&) = default;

  // True if the pad has not moved since the last step, and `may_rest`: nothing else has changed.
  bool rests(const Pose& pose, bool may_rest);
  // The result of the last call.
  [[nodiscard]] bool rests() const { return rests_; }
  // The step of a pad that rests: it keeps its state, and slipping elements stick.
  void keep_state(const kernel::Columns& columns) const;

  // Moves the tips to the loaded surface, seen along the axes. The contact points are then those of
  // the loaded tips.
  void place_tips(const kernel::Columns& columns, const Pose& pose);
  // Finds the normal forces from the gaps. `plane`: the surface is a plane.
  void press(const kernel::Columns& columns, const Pose& pose, bool plane);
  // Finds the tangential forces, the slip and the states. `placed`: there was a step before.
  void shear(const kernel::Columns& columns, const Pose& pose, bool placed);

  // The pad's pose in the last step, which is part of the state: rotation and position.
  [[nodiscard]] std::span<double> pose() { return std::span(values_).last(pose_size); }

 private:
  static constexpr std::size_t pose_size = 12;

  void shear_until_none_begins(const kernel::Columns& columns);

  SkinEffect* effect_;
  std::size_t count_;
  std::vector<double> values_;  // of the columns, and the pose
  SkinColumns own_;             // into values_
  bool one_axis_;               // true if all elements have the same axis
  bool rests_ = false;
};

}  // namespace slipbench
