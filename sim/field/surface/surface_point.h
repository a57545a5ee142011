// What an element of a pad meets on a touched surface.
#pragma once

namespace slipbench {

// Places that differ by less are one [m]: the rounding of coordinates.
inline constexpr double same_place = 1e-9;

// What an element meets: `gap` is the signed distance of its undeformed tip [m] (negative: penetration), `normal` the unit
// outward normal of the surface there. An element whose axis points away from every face near it never touches: its gap is
// positive.
//
// `faces`, a bit for each face of a surface with edges: of a tip outside, those beyond whose planes it lies; of a tip inside, the
// one that it meets; none where it meets none. A tip meets a face without a jump of its gap if it had that bit the moment before.
struct SurfacePoint {
  static constexpr unsigned only_face = 1;  // of a surface without edges: met by whoever looks at it

  double gap;
  double nx, ny, nz;
  unsigned faces = only_face;
};

}  // namespace slipbench
