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
  // directions, the volume is positive, and a face is wider than the tolerance. The text says how to
  // repair it.
  MeshDistance(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces);

  // The distance of p from the mesh [m]; negative inside.
  [[nodiscard]] double operator()(const Eigen::Vector3d& p) const { return nearest(p).distance; }
  // Likewise, with the outward normal at the nearest point. At an edge or a corner, seen from
  // outside, the normal points at p.
  [[nodiscard]] DistanceGrid::Nearest nearest(const Eigen::Vector3d& p) const;
  // The crossings of the line through p along a unit vector with the mesh, in ascending order.
  [[nodiscard]] std::vector<DistanceGrid::Crossing> crossings(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const;

  // Samples the distances on a grid of at most `nodes` nodes, which near edges, in thin walls and in
  // narrow gaps finds the nearest face of a copy of the mesh.
  [[nodiscard]] DistanceGrid on_grid(std::size_t nodes) const;

 private:
  struct Triangle {
    std::array<Eigen::Vector3d, 3> corner;
    Eigen::Vector3d normal;  // unit; zero if never a nearest face
  };
  class Cells;  // of the copy: nearest() by the few faces that matter in a cell
  struct Node {
    Eigen::Vector3d low, high;
    // Triangles of a leaf. A count of 0: an inner node, whose children are the next node and the
    // one at `first`.
    std::uint32_t first, count;
  };
  [[nodiscard]] std::vector<Eigen::Vector3d> points(double pitch) const;
  void split(std::uint32_t first, std::uint32_t count);
  // The nearest triangle found so far, and the square of its distance.
  struct Found {
    double distance2;
    const Triangle* triangle;
  };
  void search(std::uint32_t node, const Eigen::Vector3d& p, Found& found) const;
  static void compare(const Triangle& triangle, const Eigen::Vector3d& p, Found& found);
  [[nodiscard]] DistanceGrid::Nearest result(const Found& found, const Eigen::Vector3d& p, double side) const;
  [[nodiscard]] static DistanceGrid::Nearest nearest_on(const Found& found, const Eigen::Vector3d& p, double side);
  // Calls `add(index)` for every triangle of the leaves whose boxes `touches(low, high)` accepts.
  template <class Touches, class Add>
  void collect(std::uint32_t node, const Touches& touches, const Add& add) const;
  // The nearest point of a triangle; within its edges or on them.
  struct Foot {
    Eigen::Vector3d at;
    bool within;
  };
  [[nodiscard]] static Foot foot_on(const Triangle& triangle, const Eigen::Vector3d& p);
  [[nodiscard]] int winding(std::uint32_t node, const Eigen::Vector3d& p) const;
  [[nodiscard]] static int crossing(const Triangle& triangle, const Eigen::Vector3d& p);

  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  // the root first
  double tolerance_;         // m, of the merged vertices
  bool has_shells_;          // several, so that one may hide faces of another
};

}  // namespace slipbench
