#include "sim/contact/surface/mesh_distance.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

#include "sim/core/error.h"
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

// Returns true if the faces are not one closed surface, each of whose edges has two faces.
bool has_shells(const std::vector<Face>& faces, std::size_t vertices) {
  std::vector<std::uint32_t> link(vertices);
  std::iota(link.begin(), link.end(), 0U);
  const auto root = [&link](std::uint32_t v) {
    while (link[v] != v) v = link[v] = link[link[v]];
    return v;
  };
  std::map<Edge, int> uses;
  for (const Face& face : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      link[root(face[k])] = root(face[0]);
      if (++uses[std::minmax(face[k], face[(k + 1) % 3])] > 2) return true;
    }
  }
  return std::ranges::any_of(faces, [&](const Face& face) { return root(face[0]) != root(faces.front()[0]); });
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
  if (std::ranges::all_of(triangles_, [](const Triangle& triangle) { return triangle.normal.isZero(0.0); })) {
    throw InputError(
        "every face of the mesh is narrower than " + readable_quantity(tolerance, Quantity::length) +
        ", a millionth of the mesh's longest edge: expected a body with a thickness; make the mesh thicker, or use a "
        "geom of a simple shape");
  }
  tolerance_ = tolerance;
  has_shells_ = has_shells(closed, vertices.size());
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

DistanceGrid::Nearest MeshDistance::nearest(const Eigen::Vector3d& p) const {
  Found found{std::numeric_limits<double>::infinity(), nullptr};
  search(0, p, found);
  return result(found, p, winding(0, p) == 0 ? 1.0 : -1.0);
}

DistanceGrid::Nearest MeshDistance::result(const Found& found, const Eigen::Vector3d& p, double side) const {
  DistanceGrid::Nearest nearest = nearest_on(found, p, side);
  if (has_shells_ && side < 0.0) {
    constexpr double beyond = 10.0;  // tolerances
    const Eigen::Vector3d behind = p + (beyond * tolerance_ - nearest.distance) * nearest.normal;
    nearest.hidden = winding(0, behind) != 0;
  }
  return nearest;
}

// `side`: 1 outside, -1 inside.
DistanceGrid::Nearest MeshDistance::nearest_on(const Found& found, const Eigen::Vector3d& p, double side) {
  const double distance = std::sqrt(found.distance2);
  const Eigen::Vector3d& face = found.triangle->normal;
  const Foot foot = foot_on(*found.triangle, p);
  // Closer to the mesh than this [m] the difference is lost in rounding.
  constexpr double on_surface = 1e-12;
  if (!(distance > on_surface)) return {side * distance, face};
  if (foot.within) return {side * distance, face.dot(p - foot.at) < 0.0 ? -side * face : side * face};
  return {side * distance, side / distance * (p - foot.at)};
}

// Divides the space around the mesh into cubes. For a point in one of them the nearest face is one
// of a few, which are found when the first point in the cube is asked for. Thread-safe.
class MeshDistance::Cells {
 public:
  Cells(const MeshDistance& mesh, double cell) : mesh_(mesh), cell_(cell) {
    constexpr double margin = 4.0;  // cells around the mesh; beyond, the tree is searched
    low_ = mesh_.nodes_.front().low.array() - margin * cell;
    const Eigen::Vector3d extent = mesh_.nodes_.front().high - low_;
    for (std::size_t k = 0; k < 3; ++k) counts_[k] = static_cast<std::size_t>(extent[static_cast<int>(k)] / cell + margin) + 1;
    cubes_ = std::vector<std::atomic<const Faces*>>(counts_[0] * counts_[1] * counts_[2]);
  }
  Cells(const Cells&) = delete;
  Cells& operator=(const Cells&) = delete;
  ~Cells() {
    for (const std::atomic<const Faces*>& cube : cubes_) delete cube.load();
  }

  [[nodiscard]] DistanceGrid::Nearest nearest(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d at = (p - low_) / cell_;
    std::size_t index = 0;
    Eigen::Vector3d corner;
    for (int k = 0; k < 3; ++k) {
      const std::size_t count = counts_[static_cast<std::size_t>(k)];
      if (!(at[k] >= 0.0 && at[k] < static_cast<double>(count))) return mesh_.nearest(p);
      const auto i = static_cast<std::size_t>(at[k]);
      index = index * count + i;
      corner[k] = low_[k] + static_cast<double>(i) * cell_;
    }
    const Faces& faces = faces_in(index, corner);
    if (faces.near.size() > most_faces) return mesh_.nearest(p);
    Found found{std::numeric_limits<double>::infinity(), nullptr};
    const double from_middle = (p - corner - Eigen::Vector3d::Constant(0.5 * cell_)).norm() + slack * cell_;
    for (const auto& [distance, face] : faces.near) {
      const double least = distance - from_middle;  // from p
      if (least > 0.0 && least * least > found.distance2) break;
      compare(mesh_.triangles_[face], p, found);
    }
    if (faces.side != 0.0) return mesh_.result(found, p, faces.side);
    int winding = 0;
    for (const std::uint32_t face : faces.ahead) winding += crossing(mesh_.triangles_[face], p);
    return mesh_.result(found, p, winding == 0 ? 1.0 : -1.0);
  }

  [[nodiscard]] const MeshDistance& mesh() const { return mesh_; }

 private:
  static constexpr double slack = 1e-6;  // cells, for the rounding of positions
  // Near the middle of a fine ball every face may be the nearest: from this number on the tree is
  // searched, which is faster and needs no memory.
  static constexpr std::size_t most_faces = 1000;
  struct Faces {
    // With their distances from the middle of the cube [m], in ascending order: for any point of the
    // cube one of them is the nearest.
    std::vector<std::pair<double, std::uint32_t>> near;
    std::vector<std::uint32_t> ahead;  // all that a ray along +x from such a point may meet
    double side;                       // of the whole cube; 0: the mesh may pass through it
  };

  const Faces& faces_in(std::size_t index, const Eigen::Vector3d& corner) const {
    std::atomic<const Faces*>& cube = cubes_[index];
    if (const Faces* const known = cube.load(std::memory_order_acquire)) return *known;
    auto found = std::make_unique<const Faces>(faces_of(corner));
    const Faces* present = nullptr;
    if (cube.compare_exchange_strong(present, found.get(), std::memory_order_acq_rel)) return *found.release();
    return *present;  // another thread was faster, with the same faces
  }

  [[nodiscard]] Faces faces_of(const Eigen::Vector3d& corner) const {
    const Eigen::Vector3d middle = corner.array() + 0.5 * cell_;
    const double reach = (0.5 * std::sqrt(3.0) + slack) * cell_;  // of the cube about its middle
    const DistanceGrid::Nearest at_middle = mesh_.nearest(middle);
    Faces faces{{}, {}, 0.0};
    // The face nearest to the middle is no farther than this from any point of the cube, and one
    // that is nearer there is no farther than this and `reach` from the middle.
    const double farthest = std::abs(at_middle.distance) + 2.0 * reach;
    mesh_.collect(
        0,
        [&](const auto& low, const auto& high) {
          return faces.near.size() <= most_faces && distance2_to_box(middle, low, high) <= farthest * farthest;
        },
        [&](std::uint32_t face) {
          const Triangle& triangle = mesh_.triangles_[face];
          if (triangle.normal.isZero(0.0)) return;
          const double distance = (middle - foot_on(triangle, middle).at).norm();
          if (distance <= farthest) faces.near.emplace_back(distance, face);
        });
    if (faces.near.size() > most_faces) return faces;
    std::ranges::sort(faces.near);
    if (std::abs(at_middle.distance) > reach) {
      faces.side = at_middle.distance > 0.0 ? 1.0 : -1.0;
      return faces;
    }
    const Eigen::Vector3d from = corner.array() - slack * cell_, to = corner.array() + (1.0 + slack) * cell_;
    const auto ahead = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
      return high.x() >= from.x() && high.y() >= from.y() && high.z() >= from.z() && low.y() <= to.y() && low.z() <= to.z();
    };
    mesh_.collect(0, ahead, [&](std::uint32_t face) {
      const auto& [a, b, c] = mesh_.triangles_[face].corner;
      if (ahead(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c))) faces.ahead.push_back(face);
    });
    return faces;
  }

  MeshDistance mesh_;
  double cell_;  // m
  Eigen::Vector3d low_;
  std::array<std::size_t, 3> counts_{};
  mutable std::vector<std::atomic<const Faces*>> cubes_;  // null: not asked for yet
};

DistanceGrid MeshDistance::on_grid(std::size_t nodes) const {
  const Eigen::Vector3d &low = nodes_.front().low, &high = nodes_.front().high;
  const double cell = DistanceGrid::cell_for(high - low, nodes);
  const auto cells = std::make_shared<const Cells>(*this, cell);
  return {[this](const Eigen::Vector3d& p) { return nearest(p); },
          [cells](const Eigen::Vector3d& p) { return cells->nearest(p); },
          [cells](const Eigen::Vector3d& p, const Eigen::Vector3d& direction) { return cells->mesh().crossings(p, direction); },
          points(cell),
          low,
          high,
          cell};
}

// Returns points of the surface, at most `pitch` [m] apart along two edges of each triangle: the
// centres of equal parts of it.
std::vector<Eigen::Vector3d> MeshDistance::points(double pitch) const {
  std::vector<Eigen::Vector3d> result;
  for (const auto& [corner, normal] : triangles_) {
    const Eigen::Vector3d ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const auto parts = static_cast<int>(std::ceil(std::max(ab.norm(), ac.norm()) / pitch));
    const double step = 1.0 / parts;
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        result.emplace_back(corner[0] + (i + 1.0 / 3.0) * step * ab + (j + 1.0 / 3.0) * step * ac);
      }
    }
  }
  return result;
}

void MeshDistance::compare(const Triangle& triangle, const Eigen::Vector3d& p, Found& found) {
  if (triangle.normal.isZero(0.0)) return;
  const double distance2 = (p - foot_on(triangle, p).at).squaredNorm();
  if (distance2 < found.distance2) found = {distance2, &triangle};
}

template <class Touches, class Add>
void MeshDistance::collect(std::uint32_t at, const Touches& touches, const Add& add) const {
  const Node& node = nodes_[at];
  if (!touches(node.low, node.high)) return;
  for (std::uint32_t i = 0; i < node.count; ++i) add(node.first + i);
  if (node.count > 0) return;
  collect(at + 1, touches, add);
  collect(node.first, touches, add);
}

void MeshDistance::search(std::uint32_t at, const Eigen::Vector3d& p, Found& found) const {
  const Node& node = nodes_[at];
  if (node.count > 0) {
    for (std::uint32_t i = 0; i < node.count; ++i) compare(triangles_[node.first + i], p, found);
    return;
  }
  std::uint32_t near = at + 1, far = node.first;
  double way_to_near = distance2_to_box(p, nodes_[near].low, nodes_[near].high);
  double way_to_far = distance2_to_box(p, nodes_[far].low, nodes_[far].high);
  if (way_to_far < way_to_near) {
    std::swap(near, far);
    std::swap(way_to_near, way_to_far);
  }
  if (way_to_near < found.distance2) search(near, p, found);
  if (way_to_far < found.distance2) search(far, p, found);
}

// By the region that p projects to: a corner, an edge or the face ([ericson2005], sec. 5.1.5).
MeshDistance::Foot MeshDistance::foot_on(const Triangle& triangle, const Eigen::Vector3d& p) {
  const auto& [a, b, c] = triangle.corner;
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double ab_a = ab.dot(p - a), ac_a = ac.dot(p - a);
  if (ab_a <= 0.0 && ac_a <= 0.0) return {a, false};
  const double ab_b = ab.dot(p - b), ac_b = ac.dot(p - b);
  if (ab_b >= 0.0 && ac_b <= ab_b) return {b, false};
  const double over_c = ab_a * ac_b - ab_b * ac_a;
  if (over_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0) return {a + ab_a / (ab_a - ab_b) * ab, false};
  const double ab_c = ab.dot(p - c), ac_c = ac.dot(p - c);
  if (ac_c >= 0.0 && ab_c <= ac_c) return {c, false};
  const double over_b = ab_c * ac_a - ab_a * ac_c;
  if (over_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0) return {a + ac_a / (ac_a - ac_c) * ac, false};
  const double over_a = ab_b * ac_c - ab_c * ac_b;
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  if (over_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) return {b + from_b / (from_b + from_c) * (c - b), false};
  const double whole = over_a + over_b + over_c;
  return {a + over_b / whole * ab + over_c / whole * ac, true};
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

// Turns as in crossing(), with the line for the ray. Corners are projected one by one, hence equally
// for all faces at a corner: a line through an edge crosses exactly one of its faces.
std::vector<DistanceGrid::Crossing> MeshDistance::crossings(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  const Eigen::Vector3d width_u = u.cwiseAbs(), width_v = v.cwiseAbs();
  const auto touches = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const Eigen::Vector3d middle = 0.5 * (low + high) - p, half = 0.5 * (high - low).array() + tolerance_;
    return std::abs(u.dot(middle)) <= width_u.dot(half) && std::abs(v.dot(middle)) <= width_v.dot(half);
  };
  std::vector<DistanceGrid::Crossing> result;
  collect(0, touches, [&](std::uint32_t index) {
    const Triangle& triangle = triangles_[index];
    double across[3], up[3], along[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = triangle.corner[k] - p;
      across[k] = u.dot(corner);
      up[k] = v.dot(corner);
      along[k] = direction.dot(corner);
    }
    int turns = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const bool rises = up[k] <= 0.0;
      if (rises == (up[next] <= 0.0)) continue;
      const std::size_t low = rises ? k : next, high = rises ? next : k;
      if ((across[high] - across[low]) * -up[low] > (up[high] - up[low]) * -across[low]) turns += rises ? 1 : -1;
    }
    if (turns == 0) return;
    const auto& [a, b, c] = triangle.corner;
    const Eigen::Vector3d n = (b - a).cross(c - a);
    const auto [least, most] = std::minmax({along[0], along[1], along[2]});
    const double way = n.dot(a - p) / n.dot(direction);  // of a sliver this may be wrong
    result.push_back({std::isfinite(way) ? std::clamp(way, least, most) : least, turns, triangle.normal});
  });
  std::ranges::sort(result, {}, &DistanceGrid::Crossing::way);
  for (DistanceGrid::Crossing& each : result) {
    if (each.normal.isZero(0.0)) each.normal = nearest(p + each.way * direction).normal;
  }
  return result;
}

}  // namespace slipbench
