// A pad that may touch several surfaces: each of its elements meets one of them at a time.
//
// Objects made of several primitives, and convex decompositions of meshes, overlap as a rule. What an element meets is the union of all that it
// may touch: a spring for each surface would count the same load twice.
// - An element that touches nothing meets the face that it passed first along its axis: from its tip the way goes back through all surfaces that
//   lie in or against each other, and a face between two of them is not met. Of two faces at the same place it is that of the first surface.
// - An element that touches keeps its surface as long as its tip is inside of that, unless the face of another one comes to lie before it. A face
//   that comes from below, as where a slope begins, does so by no more than the tip moves in the step. One that lies before by more was met from
//   the side, which no element feels (field.h), and is not taken.
// - Where the surface changes, the element goes on with the stretch that it has and no more depth than it has (Field::hand_over): no
//   force is lost on a seam between two level faces, and a step in the surface gives no energy.
#pragma once

#include <span>

#include "sim/core/pose.h"
#include "sim/field/field.h"

namespace slipbench {

// Steps the fields of one pad, one for each surface that it may touch, all of one layout. `pads` is the pose of the pad in each surface at the end of
// the step, `dt` and `motions` (one for each surface, or empty) are as in Field::step(), which this is with one field. Throws InputError if a pad with
// an elastic skin touches two surfaces at once, or if an element is on the seam of two meshes; std::logic_error if an element touched two surfaces,
// which is a fault of this file.
void step_on_surfaces(std::span<Field> fields, std::span<const Pose> pads, double dt, std::span<const Twist> motions);

// Prepares steps that take one field at a time, to poses near `pads` (the pad in each surface): excludes every element from all surfaces but the one
// that it touches, or that it would meet first along its axis. An element that crosses a seam in such a step has no force in this step.
void exclude_all_but_first(std::span<Field> fields, std::span<const Pose> pads);

}  // namespace slipbench
