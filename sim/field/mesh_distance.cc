#include "sim/field/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "sim/core/error.h"

namespace slipbench {
namespace {

using Face = MeshDistance::Face;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::uint32_t leaf_size = 4;

// The faces by the first vertex at each place, without those that have two corners at one.
std::vector<Face> welded(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces) {
  std::map<std::array<double, 3>, std::uint32_t> first_at;
  std::vector<std::uint32_t> same_as;
  for (const Eigen::Vector3d& v : vertices) {
    if (!v.allFinite()) throw InputError("a vertex of the mesh is not finite");
    const auto next = static_cast<std::uint32_t>(same_as.size());
    same_as.push_back(first_at.try_emplace({v.x(), v.y(), v.z()}, next).first->second);
  }
  std::vector<Face> result;
  for (Face face : faces) {
    for (std::uint32_t& corner : face) {
      if (corner >= same_as.size()) {
        throw InputError("a face of the mesh names vertex " + std::to_string(corner) + " of " + std::to_string(same_as.size()));
      }
      corner = same_as[corner];
    }
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) result.push_back(face);
  }
  return result;
}

// Unit normal; zero for three corners on a line.
Eigen::Vector3d normal_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double size = n.norm();
  return size > 0.0 ? Eigen::Vector3d(n / size) : Eigen::Vector3d::Zero();
}

double distance2_to_box(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

MeshDistance::MeshDistance(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces) {
  const std::vector<Face> closed = welded(vertices, faces);
  if (closed.empty()) throw InputError("the mesh has no faces");
  std::map<Edge, std::size_t> face_at;
  std::size_t twice = 0;
  for (std::size_t f = 0; f < closed.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) twice += face_at.try_emplace({closed[f][k], closed[f][(k + 1) % 3]}, f).second ? 0 : 1;
  }
  const auto open = static_cast<std::size_t>(std::count_if(face_at.begin(), face_at.end(), [&](const auto& entry) {
    return !face_at.contains({entry.first.second, entry.first.first});
  }));
  if (open + twice > 0) {
    throw InputError("the mesh is not closed: of the " + std::to_string(3 * closed.size()) + " edges of its faces " +
                     std::to_string(open) + " meet no other face and " + std::to_string(twice) +
                     " more than one, or one that faces the other way; allowed: each meets just one");
  }

  double volume = 0.0;  // six times it
  for (const Face& face : closed) volume += vertices[face[0]].dot(vertices[face[1]].cross(vertices[face[2]]));
  if (!(volume > 0.0))
    throw InputError("the mesh is inside out or flat; allowed: corners that run counter-clockwise seen from outside");

  std::vector<Eigen::Vector3d> normals, around(vertices.size(), Eigen::Vector3d::Zero());
  for (const Face& face : closed) {
    normals.push_back(normal_of(vertices[face[0]], vertices[face[1]], vertices[face[2]]));
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = vertices[face[(k + 1) % 3]] - vertices[face[k]],
                            b = vertices[face[(k + 2) % 3]] - vertices[face[k]];
      around[face[k]] += std::atan2(a.cross(b).norm(), a.dot(b)) * normals.back();
    }
  }
  for (std::size_t f = 0; f < closed.size(); ++f) {
    Triangle triangle;
    triangle.normal = normals[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t here = closed[f][k], next = closed[f][(k + 1) % 3];
      triangle.corner[k] = vertices[here];
      triangle.at_corner[k] = around[here];
      triangle.at_edge[k] = normals[f] + normals[face_at.at({next, here})];
    }
    triangles_.push_back(std::move(triangle));
  }
  split(0, static_cast<std::uint32_t>(triangles_.size()));
}

// Appends the tree of these triangles to the nodes; sorts them on the way.
void MeshDistance::split(std::uint32_t first, std::uint32_t count) {
  const auto begin = triangles_.begin() + first, end = begin + count;
  Node node{begin->corner[0], begin->corner[0], first, count};
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  high = -low;  // of the triangles' middles
  const auto middle = [](const Triangle& t) { return Eigen::Vector3d(t.corner[0] + t.corner[1] + t.corner[2]); };
  std::for_each(begin, end, [&](const Triangle& triangle) {
    for (const Eigen::Vector3d& corner : triangle.corner) {
      node.low = node.low.cwiseMin(corner);
      node.high = node.high.cwiseMax(corner);
    }
    low = low.cwiseMin(middle(triangle));
    high = high.cwiseMax(middle(triangle));
  });
  const std::size_t at = nodes_.size();
  nodes_.push_back(node);
  if (count <= leaf_size) return;
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, end,
                   [&](const Triangle& a, const Triangle& b) { return middle(a)[axis] < middle(b)[axis]; });
  nodes_[at].count = 0;
  split(first, half);
  nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
  split(first + half, count - half);
}

double MeshDistance::operator()(const Eigen::Vector3d& p) const {
  Nearest nearest{std::numeric_limits<double>::infinity(), 1.0};
  search(0, p, nearest);
  return std::copysign(std::sqrt(nearest.distance2), nearest.side);
}

DistanceGrid MeshDistance::on_grid(std::size_t nodes) const {
  const Eigen::Vector3d &low = nodes_.front().low, &high = nodes_.front().high;
  const double cell = DistanceGrid::cell_for(high - low, nodes);
  DistanceGrid grid(*this, low, high, cell);
  // A cell below the middle of a face the grid must see a good part of that depth: below a wall of two cells it sees all of it,
  // up to the blending of its two sides; below an edge of 90 degrees, from its very rim, 0.7 of it.
  double area = 0.0, thin = 0.0;
  for (const Triangle& t : triangles_) {
    const double share = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]).norm();
    const Eigen::Vector3d below = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0 - cell * t.normal;
    const SurfacePoint met = grid.at(below.x(), below.y(), below.z(), -t.normal.x(), -t.normal.y(), -t.normal.z());
    area += share;
    if (!(met.gap < -0.5 * cell)) thin += share;
  }
  if (thin > thin_share * area) {
    throw InputError("the mesh is too thin: over " + std::to_string(static_cast<int>(100.0 * thin / area)) +
                     " % of its area it is thinner than two cells of its grid, " + std::to_string(2e3 * cell) +
                     " mm; allowed: up to 10 %");
  }
  return grid;
}

void MeshDistance::search(std::uint32_t at, const Eigen::Vector3d& p, Nearest& nearest) const {
  const Node& node = nodes_[at];
  if (node.count > 0) {
    for (std::uint32_t i = 0; i < node.count; ++i) meet(triangles_[node.first + i], p, nearest);
    return;
  }
  std::uint32_t near = at + 1, far = node.first;
  double way_to_near = distance2_to_box(p, nodes_[near].low, nodes_[near].high);
  double way_to_far = distance2_to_box(p, nodes_[far].low, nodes_[far].high);
  if (way_to_far < way_to_near) {
    std::swap(near, far);
    std::swap(way_to_near, way_to_far);
  }
  if (way_to_near < nearest.distance2) search(near, p, nearest);
  if (way_to_far < nearest.distance2) search(far, p, nearest);
}

// The nearest point of a triangle by the region that p lies over: a corner, an edge or the face (Ericson, Real-Time Collision
// Detection, 2005, sec. 5.1.5).
void MeshDistance::meet(const Triangle& triangle, const Eigen::Vector3d& p, Nearest& nearest) {
  const auto& [a, b, c] = triangle.corner;
  const auto take = [&](const Eigen::Vector3d& foot, const Eigen::Vector3d& pseudonormal) {
    const Eigen::Vector3d way = p - foot;
    const double distance2 = way.squaredNorm();
    if (distance2 < nearest.distance2) nearest = {distance2, way.dot(pseudonormal)};
  };
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double ab_a = ab.dot(p - a), ac_a = ac.dot(p - a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return take(a, triangle.at_corner[0]);
  const double ab_b = ab.dot(p - b), ac_b = ac.dot(p - b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return take(b, triangle.at_corner[1]);
  const double over_c = ab_a * ac_b - ab_b * ac_a;
  if (over_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return take(a + ab_a / (ab_a - ab_b) * ab, triangle.at_edge[0]);
  const double ab_c = ab.dot(p - c), ac_c = ac.dot(p - c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return take(c, triangle.at_corner[2]);
  const double over_b = ab_c * ac_a - ab_a * ac_c;
  if (over_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return take(a + ac_a / (ac_a - ac_c) * ac, triangle.at_edge[2]);
  const double over_a = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (over_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) return take(b + from_b / (from_b + from_c) * (c - b), triangle.at_edge[1]);
  const double whole = over_a + over_b + over_c;
  take(a + over_b / whole * ab + over_c / whole * ac, triangle.normal);
}

}  // namespace slipbench
