// The signed distance to a closed triangle mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "sim/contact/surface/distance_grid.h"

namespace slipbench {

// The mesh itself, with its hollows, not its convex hull. Vertices within weld_share of the longest
// edge of each other are merged. Faces with two equal corners are dropped, and faces no wider than
// that tolerance are never the nearest, since their neighbours are as near. A point is inside if
// the mesh winds around it: a ray from there leaves through faces more often than it enters
// [jacobson2013]. Each edge is crossed on the same side for both its faces, so the count is exact
// for a closed mesh, and needs no normals, which slivers do not have. Several shells may touch or
// intersect: a point is inside if it is inside any of them, at the distance of the nearest face,
// hidden or not. The nearest face is found in a tree of boxes.
class MeshDistance {
 public:
  using Face = std::array<std::uint32_t, 3>;  // vertices, counter-clockwise from outside

  static constexpr double weld_share = 1e-6;

  // Throws InputError unless every face has three vertices of `vertices` [m], these are finite, and
  // the mesh is closed with an outward orientation: each edge is used equally often in both
  // directions, and the volume is positive. The text says how to repair it.
  MeshDistance(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces);

  // The distance of p from the mesh [m]; negative inside.
  [[nodiscard]] double operator()(const Eigen::Vector3d& p) const;

  // Samples the distances on a grid of at most `nodes` nodes. Throws InputError if more than
  // thin_share of the mesh's area belongs to walls thinner than two cells, which the grid would
  // lose.
  [[nodiscard]] DistanceGrid on_grid(std::size_t nodes) const;
  static constexpr double thin_share = 0.1;

 private:
  struct Triangle {
    std::array<Eigen::Vector3d, 3> corner;
    Eigen::Vector3d normal;  // unit; zero if never a nearest face
  };
  struct Node {
    Eigen::Vector3d low, high;
    // Triangles of a leaf. A count of 0: an inner node, whose children are the next node and the
    // one at `first`.
    std::uint32_t first, count;
  };
  void split(std::uint32_t first, std::uint32_t count);
  void search(std::uint32_t node, const Eigen::Vector3d& p, double& distance2) const;
  [[nodiscard]] static double distance2_to(const Triangle& triangle, const Eigen::Vector3d& p);
  [[nodiscard]] int winding(std::uint32_t node, const Eigen::Vector3d& p) const;
  [[nodiscard]] static int crossing(const Triangle& triangle, const Eigen::Vector3d& p);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  // the root first
};

}  // namespace slipbench
