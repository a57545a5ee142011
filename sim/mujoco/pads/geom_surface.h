// What a pad touches when it touches a MuJoCo geom.
#pragma once

#include <cstddef>

#include "sim/core/pose.h"
#include "sim/field/surface/surface.h"

struct mjModel_;

namespace slipbench {

struct GeomSurface {
  Surface shape;
  Pose in_geom;  // of the surface frame in the geom's frame (geom_xpos, geom_xmat)
};

// A mesh's distances are kept at up to so many nodes (3 MB): for a compact object, cells of about a sixtieth of its longest edge.
inline constexpr std::size_t mesh_grid_nodes = 400'000;

// The surface of geom `geom` of a compiled model. Plane (endless, whatever size it is drawn with), box, sphere, cylinder,
// capsule and ellipsoid are exact. A mesh is the mesh itself, with its hollows - MuJoCo's own contact takes its convex hull - by
// way of a grid: where the mesh is smooth and 6 cells or more from an edge or from the middle of a wall, the gap is that of the
// triangles to the fourth order of the cell; nearer to an edge it is rounded by up to a fifth of a cell. Like a sphere, a mesh
// has one side at each point, that of its nearest one: an element that is deeper than its distance from an edge meets the side
// beyond the edge, and nothing where its axis does not look at that. So a box is better a box. A mesh's grid takes about a
// second to make and is shared by all who ask for the same mesh while one of them lives; may be called from several threads.
//
// Throws std::invalid_argument for a geom that is not in the model, and InputError, which names the geom, its mesh and a remedy, for one of
// another type (height field, sdf) and for a mesh that is not closed or too thin for its grid (surface.h).
GeomSurface surface_of_geom(const mjModel_* model, int geom);

}  // namespace slipbench
