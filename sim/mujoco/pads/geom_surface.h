// The surface of a touched MuJoCo geom.
#pragma once

#include <array>
#include <cstddef>

#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

struct GeomSurface {
  Surface shape;
  Pose in_geom;  // of the surface frame in the geom's frame (geom_xpos, geom_xmat)
};

// Values of a model that determine a geom's surface, apart from the vertices and faces of its mesh.
struct ShapeValues {
  int type;                    // mjtGeom
  int mesh;                    // -1: none
  std::array<double, 3> size;  // m; 0 where the type has fewer

  bool operator==(const ShapeValues&) const = default;
};
ShapeValues shape_values(ModelView model, int geom);

// Largest number of nodes of a mesh's distance grid (7 MB): for a compact object, cells of about a
// sixtieth of its longest edge.
inline constexpr std::size_t mesh_grid_nodes = 400'000;

// Returns the surface of geom `geom` of a compiled model. Plane (infinite, whatever its drawn
// size), box, sphere, cylinder, capsule and ellipsoid are exact. A mesh is the mesh itself, with
// its hollows (MuJoCo's own contact uses its convex hull): exactly the triangles near edges, in thin
// walls and in narrow gaps, and elsewhere a smooth surface through them, from a grid
// (distance_grid.h). An element meets the nearest face, or the face that it entered if the nearest one looks
// away from it or is hidden by another shell. An element that leaves through the other side of a wall
// is refused (Field::lost()). A mesh's grid takes about a second to compute and is shared by all users of the same mesh while one
// of them exists. Thread-safe.
//
// Throws std::invalid_argument for a geom that is not in the model, and InputError, which names the
// geom, its mesh and a remedy, for a geom of another type (height field, sdf), for a size that is
// not positive and finite, and for a mesh that is not closed.
GeomSurface surface_of_geom(ModelView model, int geom);

}  // namespace slipbench
