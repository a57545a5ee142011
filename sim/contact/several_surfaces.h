// A pad that may touch several surfaces: each of its elements meets one of them at a time.
//
// Objects made of several primitives, and convex decompositions of meshes, usually overlap. An
// element meets the union of all that it may touch: a spring for each surface would count the same
// load twice.
// - An element without contact meets the face that it passed first along its axis. The path from
//   its tip goes back through all surfaces that overlap or adjoin each other; a face between two of
//   them is not met. Of two faces at the same position that of the first surface is met.
// - An element in contact keeps its surface while its tip is inside, unless a face of another
//   surface comes to lie before it. A face that comes from below, as where a slope begins, lies
//   before it by no more than the tip moves in the step. One that lies before it by more was met
//   from the side, which no element feels (field.h), and is ignored.
// - Where the surface changes, the element keeps its stretch and no more than its depth
//   (Field::hand_over): no force is lost on a seam between two level faces, and a step in the
//   surface delivers no energy.
#pragma once

#include <span>

#include "sim/contact/field.h"
#include "sim/core/pose.h"

namespace slipbench {

// Steps the fields of one pad, one for each surface that it may touch, all with the same layout.
// `pads` is the pad's pose in each surface at the end of the step; `dt` and `motions` (one per
// surface, or empty) are as in Field::step(), to which this is equal for one field. Throws
// InputError if a pad with an elastic skin touches two surfaces at once, or if an element is on the
// seam of two meshes; std::logic_error if an element touches two surfaces, which is a bug.
void step_on_surfaces(std::span<Field> fields, std::span<const Pose> pads, double dt, std::span<const Twist> motions);

// Prepares steps that take one field at a time, to poses near `pads` (the pad in each surface):
// excludes every element from all surfaces but the one that it touches, or that it would meet first
// along its axis. An element that crosses a seam in such a step has no force in this step.
void exclude_all_but_first(std::span<Field> fields, std::span<const Pose> pads);

}  // namespace slipbench
