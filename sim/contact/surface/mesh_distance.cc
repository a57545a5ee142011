#include "sim/contact/surface/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench {
namespace {

using Face = MeshDistance::Face;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::uint32_t leaf_size = 4;

// Maps vertices to the first one within a tolerance, by the cells of a grid, many tolerances wide.
class Weld {
 public:
  explicit Weld(double tolerance) : tolerance_(tolerance) {}

  // Returns the first vertex within the tolerance of this one, or else `next`, which is stored.
  std::uint32_t first_at(const Eigen::Vector3d& v, std::uint32_t next) {
    const Cell low = cell_of(v.array() - tolerance_), high = cell_of(v.array() + tolerance_);
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          for (const auto& [at, vertex] : found->second) {
            if ((at - v).norm() <= tolerance_) return vertex;
          }
        }
      }
    }
    cells_[cell_of(v)].emplace_back(v, next);
    return next;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr double width = 64.0;  // of a cell, in tolerances

  [[nodiscard]] Cell cell_of(const Eigen::Array3d& v) const {
    const double size = width * tolerance_;
    const auto index = [size](double x) { return size > 0.0 ? static_cast<std::int64_t>(std::floor(x / size)) : 0; };
    return {index(v.x()), index(v.y()), index(v.z())};
  }

  double tolerance_;
  std::map<Cell, std::vector<std::pair<Eigen::Vector3d, std::uint32_t>>> cells_;
};

// Returns the faces with each vertex replaced by the first one at its position, without faces that
// have two equal corners.
std::vector<Face> welded(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces, double tolerance) {
  Weld weld(tolerance);
  std::vector<std::uint32_t> same_as;
  for (const Eigen::Vector3d& v : vertices) same_as.push_back(weld.first_at(v, static_cast<std::uint32_t>(same_as.size())));
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

// Each edge must be used equally often in both directions.
void refuse_open(const std::vector<Face>& faces) {
  struct Runs {
    int all = 0, more_up = 0;  // from the lower to the higher vertex
  };
  std::map<Edge, Runs> edges;
  for (const Face& face : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t here = face[k], next = face[(k + 1) % 3];
      Runs& runs = edges[std::minmax(here, next)];
      ++runs.all;
      runs.more_up += here < next ? 1 : -1;
    }
  }
  std::size_t open = 0, turned = 0;
  for (const auto& [edge, runs] : edges) {
    if (runs.more_up != 0) ++(runs.all % 2 != 0 ? open : turned);
  }
  if (open + turned == 0) return;
  throw InputError(
      "the mesh is not closed: " + std::to_string(open) + " of its " + std::to_string(edges.size()) +
      " edges lack a face on one side, and at " + std::to_string(turned) +
      " edges the two faces have opposite normals; close the holes and turn the normals outwards in a mesh editor, or use geoms of simple shapes");
}

// Returns the unit normal; zero if a corner is no farther than `width` from the opposite, longest
// edge.
Eigen::Vector3d normal_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double width) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const double twice_area = n.norm(), longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return twice_area > width * longest ? Eigen::Vector3d(n / twice_area) : Eigen::Vector3d::Zero();
}

double distance2_to_box(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
}

}  // namespace

MeshDistance::MeshDistance(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Face>& faces) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : vertices) {
    if (!v.allFinite()) throw InputError("a vertex of the mesh is not finite");
    box.extend(v);
  }
  const double tolerance = box.isEmpty() ? 0.0 : weld_share * box.sizes().maxCoeff();
  const std::vector<Face> closed = welded(vertices, faces, tolerance);
  if (closed.empty()) throw InputError("the mesh has no faces; expected a closed mesh");
  refuse_open(closed);

  double volume = 0.0;  // times six
  for (const Face& face : closed) volume += vertices[face[0]].dot(vertices[face[1]].cross(vertices[face[2]]));
  if (!(volume > 0.0)) {
    throw InputError(
        "the mesh is inside out or flat: the corners of a face must run counter-clockwise seen from outside; flip the normals in a mesh editor");
  }
  for (const auto& [a, b, c] : closed) {
    triangles_.push_back({{vertices[a], vertices[b], vertices[c]}, normal_of(vertices[a], vertices[b], vertices[c], tolerance)});
  }
  split(0, static_cast<std::uint32_t>(triangles_.size()));
}

// Appends the tree of these triangles to the nodes and sorts the triangles.
void MeshDistance::split(std::uint32_t first, std::uint32_t count) {
  const auto begin = triangles_.begin() + first, end = begin + count;
  Node node{begin->corner[0], begin->corner[0], first, count};
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  high = -low;  // bounds of the triangles' centres
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
  double distance2 = std::numeric_limits<double>::infinity();
  search(0, p, distance2);
  return winding(0, p) == 0 ? std::sqrt(distance2) : -std::sqrt(distance2);
}

DistanceGrid MeshDistance::on_grid(std::size_t nodes) const {
  const Eigen::Vector3d &low = nodes_.front().low, &high = nodes_.front().high;
  const double cell = DistanceGrid::cell_for(high - low, nodes);
  DistanceGrid grid(*this, low, high, cell);
  // A cell below the middle of a face the grid must see a good part of that depth: below a wall of
  // two cells all of it, up to the blending of its two sides; below an edge of 90 degrees, from its
  // very rim, 0.7 of it.
  double area = 0.0, thin = 0.0;
  for (const Triangle& t : triangles_) {
    const double share = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]).norm();
    const Eigen::Vector3d below = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0 - cell * t.normal;
    const SurfacePoint met = grid.at(below.x(), below.y(), below.z(), -t.normal.x(), -t.normal.y(), -t.normal.z());
    area += share;
    if (!(met.gap < -0.5 * cell)) thin += share;
  }
  if (thin > thin_share * area) {
    throw InputError("the mesh is too thin: " + std::to_string(static_cast<int>(100.0 * thin / area)) +
                     " % of its area is thinner than two cells of its grid, " + readable_quantity(2.0 * cell, Quantity::length) +
                     "; allowed: up to 10 %; divide it into compact meshes, or use boxes");
  }
  return grid;
}

void MeshDistance::search(std::uint32_t at, const Eigen::Vector3d& p, double& distance2) const {
  const Node& node = nodes_[at];
  if (node.count > 0) {
    for (std::uint32_t i = 0; i < node.count; ++i) distance2 = std::min(distance2, distance2_to(triangles_[node.first + i], p));
    return;
  }
  std::uint32_t near = at + 1, far = node.first;
  double way_to_near = distance2_to_box(p, nodes_[near].low, nodes_[near].high);
  double way_to_far = distance2_to_box(p, nodes_[far].low, nodes_[far].high);
  if (way_to_far < way_to_near) {
    std::swap(near, far);
    std::swap(way_to_near, way_to_far);
  }
  if (way_to_near < distance2) search(near, p, distance2);
  if (way_to_far < distance2) search(far, p, distance2);
}

// By the region that p projects to: a corner, an edge or the face ([ericson2005], sec. 5.1.5).
double MeshDistance::distance2_to(const Triangle& triangle, const Eigen::Vector3d& p) {
  if (triangle.normal.isZero(0.0)) return std::numeric_limits<double>::infinity();
  const auto& [a, b, c] = triangle.corner;
  const auto to = [&](const Eigen::Vector3d& foot) { return (p - foot).squaredNorm(); };
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double ab_a = ab.dot(p - a), ac_a = ac.dot(p - a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return to(a);
  const double ab_b = ab.dot(p - b), ac_b = ac.dot(p - b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return to(b);
  const double over_c = ab_a * ac_b - ab_b * ac_a;
  if (over_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return to(a + ab_a / (ab_a - ab_b) * ab);
  const double ab_c = ab.dot(p - c), ac_c = ac.dot(p - c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return to(c);
  const double over_b = ab_c * ac_a - ab_a * ac_c;
  if (over_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return to(a + ac_a / (ac_a - ac_c) * ac);
  const double over_a = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (over_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) return to(b + from_b / (from_b + from_c) * (c - b));
  const double whole = over_a + over_b + over_c;
  return to(a + over_b / whole * ab + over_c / whole * ac);
}

// Returns how often the ray from p along +x leaves the mesh, minus how often it enters it.
int MeshDistance::winding(std::uint32_t at, const Eigen::Vector3d& p) const {
  const Node& node = nodes_[at];
  if (p.x() > node.high.x() || p.y() < node.low.y() || p.y() > node.high.y() || p.z() < node.low.z() || p.z() > node.high.z()) {
    return 0;
  }
  if (node.count == 0) return winding(at + 1, p) + winding(node.first, p);
  int sum = 0;
  for (std::uint32_t i = 0; i < node.count; ++i) sum += crossing(triangles_[node.first + i], p);
  return sum;
}

// Returns 1 if that ray leaves through the triangle, -1 if it enters, else 0. Seen along the ray,
// the winding number of the triangle's outline around p is the number of its edges that pass p on
// the side of +y going up in z, minus those going down. The side on which an edge passes is
// computed from its lower end, hence equally for both its faces: a ray through an edge meets
// exactly one of them.
int MeshDistance::crossing(const Triangle& triangle, const Eigen::Vector3d& p) {
  int turns = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d &from = triangle.corner[k], &to = triangle.corner[(k + 1) % 3];
    const bool up = from.z() <= p.z();
    if (up == (to.z() <= p.z())) continue;
    const Eigen::Vector3d &low = up ? from : to, &high = up ? to : from;
    if ((high.y() - low.y()) * (p.z() - low.z()) > (high.z() - low.z()) * (p.y() - low.y())) turns += up ? 1 : -1;
  }
  if (turns == 0) return 0;
  const auto& [a, b, c] = triangle.corner;
  // signed distance from the plane, times twice its area
  const double above = (b - a).cross(c - a).dot(p - a);
  return above * turns < 0.0 ? turns : 0;
}

}  // namespace slipbench
