// The surface of a touched MuJoCo geom.
#pragma once

#include <cstddef>

#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"

struct mjModel_;

namespace slipbench {

struct GeomSurface {
  Surface shape;
  Pose in_geom;  // of the surface frame in the geom's frame (geom_xpos, geom_xmat)
};

// Largest number of nodes of a mesh's distance grid (3 MB): for a compact object, cells of about a
// sixtieth of its longest edge.
inline constexpr std::size_t mesh_grid_nodes = 400'000;

// Returns the surface of geom `geom` of a compiled model. Plane (infinite, whatever its drawn
// size), box, sphere, cylinder, capsule and ellipsoid are exact. A mesh is the mesh itself, with
// its hollows (MuJoCo's own contact uses its convex hull), sampled on a grid: where the mesh is
// smooth and 6 cells or more from an edge or from the middle of a wall, the gap is that of the
// triangles to fourth order of the cell; nearer to an edge it is rounded by up to a fifth of a
// cell. Like a sphere, a mesh has one face at each point, the nearest one: an element that is
// deeper than its distance from an edge meets the face beyond the edge, and nothing if its axis
// does not point at that face. So a box is better modelled as a box. A mesh's grid takes about a
// second to compute and is shared by all users of the same mesh while one of them exists.
// Thread-safe.
//
// Throws std::invalid_argument for a geom that is not in the model, and InputError, which names the
// geom, its mesh and a remedy, for a geom of another type (height field, sdf) and for a mesh that
// is not closed or too thin for its grid (surface.h).
GeomSurface surface_of_geom(const mjModel_* model, int geom);

}  // namespace slipbench
