// Contact of an element of a pad with a touched surface.
#pragma once

namespace slipbench {

// Positions that differ by less [m] are equal: the rounding of coordinates.
inline constexpr double same_place = 1e-9;

// The contact of an element. `gap` is the signed distance of its undeformed tip [m] (negative:
// penetration), `nx`, `ny`, `nz` the unit outward normal of the surface there. An element whose
// axis points away from every face near it never touches: its gap is positive.
//
// `faces` has a bit for each face of a surface with edges. For a tip outside: the faces beyond
// whose planes it lies. For a tip inside: the face that it meets, if any. A tip meets a face
// without a jump of its gap if the face's bit was set in the last step.
struct SurfacePoint {
  static constexpr unsigned only_face = 1;  // for a surface without edges

  double gap;
  double nx, ny, nz;
  unsigned faces = only_face;
};

}  // namespace slipbench
