// The signed distance to a closed triangle mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "sim/field/distance_grid.h"

namespace slipbench {

// The mesh itself, hollows and all, not its convex hull. Vertices at the same place are one vertex, and faces with two corners at
// one place are left out. The sign is that of the way from the nearest point along the pseudonormal there: the normal of a face,
// the sum of those of the two faces of an edge, the sum of those around a vertex, each weighted with its angle (Baerentzen &
// Aanaes, IEEE Trans. Vis. Comput. Graph. 11(3), 2005: the sign is exact for a closed surface that does not cut itself). The
// nearest face is found in a tree of boxes.
class MeshDistance {
 public:
  using Face = std::array<std::uint32_t, 3>;  // vertices, counter-clockwise from outside

  // Throws InputError unless every face has three vertices of `vertices` [m], these are finite, and the mesh is closed and has
  // one outside: each edge of a face belongs to just one more, which runs along it the other way round, and the volume is
  // positive.
  MeshDistance(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces);

  // The distance of p from the mesh [m]; negative inside.
  [[nodiscard]] double operator()(const Eigen::Vector3d& p) const;

  // Its distances on a grid of at most `nodes` nodes. Throws InputError when more than thin_share of the mesh's area is the side
  // of walls thinner than two cells, which the grid would lose.
  [[nodiscard]] DistanceGrid on_grid(std::size_t nodes) const;
  static constexpr double thin_share = 0.1;

 private:
  struct Triangle {
    std::array<Eigen::Vector3d, 3> corner;
    // Pseudonormals, of any length: of corner k, of the edge from corner k to the next, of the face.
    std::array<Eigen::Vector3d, 3> at_corner, at_edge;
    Eigen::Vector3d normal;
  };
  struct Node {
    Eigen::Vector3d low, high;
    // Triangles of a leaf. A count of 0: an inner node, whose children are the next node and the one at `first`.
    std::uint32_t first, count;
  };
  struct Nearest {
    double distance2;
    double side;
  };

  void split(std::uint32_t first, std::uint32_t count);
  void search(std::uint32_t node, const Eigen::Vector3d& p, Nearest& nearest) const;
  static void meet(const Triangle& triangle, const Eigen::Vector3d& p, Nearest& nearest);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  // the root first
};

}  // namespace slipbench
