// The touched surfaces: signed distance, outward normal, and the face that a pad's element meets.
#pragma once

#include <cmath>
#include <variant>

#include "sim/contact/surface/box.h"
#include "sim/contact/surface/cylinder.h"
#include "sim/contact/surface/distance_grid.h"
#include "sim/contact/surface/round_shapes.h"
#include "sim/contact/surface/surface_point.h"

namespace slipbench {

// All shapes are given in the surface frame S. `at(x, y, z, ax, ay, az)`: tip and element axis in
// S. Inside a shape with several faces the face met is the one through which the element entered:
// the nearest one backwards along the element's axis, not the nearest in distance, so that a pillar
// close to an edge presses on the top and not on the side. This follows from one position alone; a
// change of face during the motion is handled by Field::keep_energy.
//
// Box and Cylinder also take the length of the element's column [m]: the distance behind its tip at
// which the column is fixed to the pad. A column meets the first flat face that it enters, however
// thin the shape is behind that face, so an element goes on pressing on a card that is thinner than
// the element is deep, even with its undeformed tip beyond the far side. A length of 0 means that
// the column is unknown: a tip nearer to a face that it points out of than to the one by which it
// entered then meets nothing.

// The half-space z <= 0.
struct Plane {
  [[nodiscard]] SurfacePoint at(double, double, double z, double, double, double az) const {
    return {az < 0.0 ? z : std::abs(z), 0.0, 0.0, 1.0};
  }
};

using Surface = std::variant<Plane, Box, Cylinder, Sphere, Capsule, Ellipsoid, DistanceGrid>;

}  // namespace slipbench
