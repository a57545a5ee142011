#include "sim/contact/contact_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "sim/core/math.h"

namespace slipbench {
namespace {

bool outside(const Plane& /*shape*/, const Eigen::Vector3d& p) { return p.z() > 0.0; }
bool outside(const Sphere& shape, const Eigen::Vector3d& p) { return p.norm() > shape.radius; }
bool outside(const Box& shape, const Eigen::Vector3d& p) { return (p.cwiseAbs() - shape.half).maxCoeff() > 0.0; }
bool outside(const Cylinder& shape, const Eigen::Vector3d& p) {
  return math::hypot(p.x(), p.y()) > shape.radius || std::abs(p.z()) > shape.half_length;
}
bool outside(const Capsule& shape, const Eigen::Vector3d& p) {
  return (p - Eigen::Vector3d(0.0, 0.0, std::clamp(p.z(), -shape.half_length, shape.half_length))).norm() > shape.radius;
}
bool outside(const Ellipsoid& shape, const Eigen::Vector3d& p) { return p.cwiseQuotient(shape.half).norm() > 1.0; }
bool outside(const DistanceGrid& /*shape*/, const Eigen::Vector3d& /*p*/) { return false; }

}  // namespace

ContactPoints::ContactPoints(const PadLayout& layout, const Surface& surface)
    : surface_(surface),
      count_(layout.elements.size()),
      axis_(layout.elements.front().axis),
      column_(std::isfinite(layout.unit_height) ? layout.unit_height : 0.0) {
  flat_pad_ = std::ranges::all_of(layout.elements, [this](const Element& e) { return e.axis == axis_; });
}

SurfacePoint ContactPoints::at(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) const {
  return std::visit(
      [&](const auto& shape) {
        if constexpr (requires { shape.is_thin(column_); }) {
          return shape.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z(), column_);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, DistanceGrid>) {
          return shape.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z(), column_in_grid());
        } else {
          return shape.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z());
        }
      },
      surface_);
}

bool ContactPoints::is_thin() const {
  return std::visit(
      [this](const auto& shape) {
        if constexpr (requires { shape.is_thin(column_); }) {
          return shape.is_thin(column_);
        } else {
          return false;
        }
      },
      surface_);
}

namespace {

using Entry = ContactPoints::Entry;

// Entry for a shape whose gap is the distance of the nearest point: marches by that distance.
template <class Shape>
std::optional<Entry> walk_out(const Shape& shape, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) {
  constexpr int most_steps = 1000;
  const auto gap = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& a) {
    return shape.at(p.x(), p.y(), p.z(), a.x(), a.y(), a.z());
  };
  const auto distance = [&](const Eigen::Vector3d& p) { return std::min(gap(p, axis).gap, gap(p, -axis).gap); };
  double way = from, inside = -distance(tip - way * axis);
  if (!(inside > -same_place)) return std::nullopt;
  for (int k = 0; k < most_steps && inside > same_place; ++k) {
    way += inside;
    inside = -distance(tip - way * axis);
  }
  const SurfacePoint met = gap(tip - way * axis, axis);
  const Eigen::Vector3d n(met.nx, met.ny, met.nz);
  if (inside > same_place || !(n.dot(axis) < 0.0)) return std::nullopt;
  return Entry{way, n, SurfacePoint::only_face};
}

std::optional<Entry> way_out(const Plane& /*shape*/, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) {
  if (!(axis.z() < 0.0) || tip.z() - from * axis.z() > same_place) return std::nullopt;
  return Entry{tip.z() / axis.z(), Eigen::Vector3d::UnitZ(), SurfacePoint::only_face};
}

std::optional<Entry> way_out(const Box& shape, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) {
  const Box::Passage passage = shape.passage(tip, axis);
  if (!(passage.from <= from + same_place)) return std::nullopt;
  return Entry{passage.way, passage.n, passage.faces};
}

std::optional<Entry> way_out(const Cylinder& shape, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) {
  const Eigen::Vector3d start = tip - from * axis;
  if (math::hypot(start.x(), start.y()) > shape.radius + same_place || std::abs(start.z()) > shape.half_length + same_place)
    return std::nullopt;
  const double end = axis.z() < 0.0 ? 1.0 : -1.0;
  const double by_cap =
      axis.z() == 0.0 ? std::numeric_limits<double>::infinity() : (shape.half_length - end * tip.z()) / std::abs(axis.z());
  // |tip - t axis|^2 = radius^2 across the cylinder's axis, the later of its two roots.
  const Eigen::Vector2d across = axis.head<2>(), place = tip.head<2>();
  const double a = across.squaredNorm(), b = place.dot(across), c = place.squaredNorm() - shape.radius * shape.radius;
  const double by_side = a == 0.0 ? std::numeric_limits<double>::infinity() : (b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
  constexpr unsigned side = 2, cap_up = 4, cap_down = 8;
  if (by_cap <= by_side) return Entry{by_cap, {0.0, 0.0, end}, end > 0.0 ? cap_up : cap_down};
  const Eigen::Vector2d n = (place - by_side * across) / shape.radius;
  return Entry{by_side, {n.x(), n.y(), 0.0}, side};
}

std::optional<Entry> way_out(const DistanceGrid& shape, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) {
  if (!shape.knows_crossings()) return walk_out(shape, tip, axis, from);
  constexpr double touching = 1e-7;  // m: meshes whose faces differ by less touch
  const std::optional<DistanceGrid::Entry> found = shape.entry(tip - (from + touching) * axis, axis);
  if (!found || !(found->normal.dot(axis) < 0.0)) return std::nullopt;
  return Entry{from + touching + found->back, found->normal, SurfacePoint::only_face};
}

template <class Shape>
std::optional<Entry> way_out(const Shape& shape, const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) {
  return walk_out(shape, tip, axis, from);
}

}  // namespace

std::optional<Entry> ContactPoints::entry(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) const {
  const std::optional<Entry> found = std::visit([&](const auto& shape) { return way_out(shape, tip, axis, from); }, surface_);
  return found && found->way > from + same_place ? found : std::nullopt;
}

Eigen::Vector3d ContactPoints::normal_at(const Eigen::Vector3d& contact, const Eigen::Vector3d& axis, unsigned faces) const {
  const Eigen::Vector3d of_face = std::visit(
      [&](const auto& shape) -> Eigen::Vector3d {
        if constexpr (requires { shape.normal_of(faces); }) return shape.normal_of(faces);
        return Eigen::Vector3d::Zero();
      },
      surface_);
  if (!of_face.isZero(0.0)) return of_face;
  const SurfacePoint met = at(contact, axis);
  return {met.nx, met.ny, met.nz};
}

bool ContactPoints::has_come_through(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, unsigned faces, double depth,
                                     const SurfacePoint& met) const {
  constexpr double far_side = 0.5;  // cosine between axis and normal
  const double along_normal = met.nx * axis.x() + met.ny * axis.y() + met.nz * axis.z();
  const auto round = [&] {  // it faces the far side, or is deep inside and faces outwards
    return along_normal > far_side || (along_normal >= 0.0 && met.gap > 0.5 * depth && is_inside(tip));
  };
  if (const Box* box = std::get_if<Box>(&surface_)) return box->is_behind(faces, tip, axis);
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&surface_)) {
    if (!cylinder->normal_of(faces).isZero(0.0)) return cylinder->is_behind(faces, tip, axis);
    constexpr unsigned side = 2;
    return (met.faces & ~side) == 0 && round();
  }
  if (on_grid()) return along_normal > far_side;  // a grid does not tell edges from sides
  return !on_plane() && round();
}

bool ContactPoints::has_left_grid(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& axis,
                                  const Eigen::Vector3d& pressed_on) const {
  const DistanceGrid& grid = std::get<DistanceGrid>(surface_);
  if (grid.passes_through(from, to, axis, pressed_on)) return true;
  constexpr double rounded = 1e-7;  // m
  return !pressed_on.isZero(0.0) && at(to, axis).gap > rounded && is_inside(to);
}

// On a grid the gaps of two opposite axes tell the side: one of them is negative inside.
bool ContactPoints::is_inside(const Eigen::Vector3d& p) const {
  const DistanceGrid* const grid = std::get_if<DistanceGrid>(&surface_);
  if (grid == nullptr) return !is_outside(p);
  return std::min(grid->at(p.x(), p.y(), p.z(), 0.0, 0.0, -1.0).gap, grid->at(p.x(), p.y(), p.z(), 0.0, 0.0, 1.0).gap) < 0.0;
}

bool ContactPoints::is_outside(const Eigen::Vector3d& p) const {
  return std::visit([&](const auto& shape) { return outside(shape, p); }, surface_);
}

void ContactPoints::find(const kernel::Columns& columns, const Pose& pose, const kernel::Groups& groups) const {
  if (on_plane()) {
    kernel::plane_gap(columns, pose, groups.count * kernel::lanes);
    if (!flat_pad_ || !faces_plane(pose)) kernel::turn_away(columns, pose, groups.count * kernel::lanes);
  } else if (const Box* box = std::get_if<Box>(&surface_)) {
    kernel::meet_box(columns, *box, pose, groups, column_);
  } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&surface_)) {
    kernel::meet_cylinder(columns, *cylinder, pose, groups, column_);
  } else {
    std::visit([&](const auto& shape) { meet(shape, columns, pose, groups); }, surface_);
  }
}

template <class Shape>
void ContactPoints::meet(const Shape& shape, const kernel::Columns& columns, const Pose& at, const kernel::Groups& groups) const {
  // Copies, since the compiler cannot know that writes to the columns change none of these.
  const kernel::Columns c = columns;
  const Pose pose = at;
  const Shape met_by = shape;  // NOLINT(performance-unnecessary-copy-initialization)
  Eigen::Vector3d axis = pose.rotation * axis_;
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t first = groups[k], end = std::min(count_, first + kernel::lanes);
    for (std::size_t i = first; i < end; ++i) {
      const Eigen::Vector3d tip = pose * c.tip.at(i);
      if (!flat_pad_) axis = pose.rotation * c.axis.at(i);
      SurfacePoint met;
      if constexpr (std::is_same_v<Shape, DistanceGrid>) {
        met = met_by.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z(), column_in_grid());
      } else {
        met = met_by.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z());
      }
      c.gap[i] = met.gap;
      c.normal.x[i] = met.nx;
      c.normal.y[i] = met.ny;
      c.normal.z[i] = met.nz;
      c.contact.x[i] = tip.x() - met.gap * met.nx;
      c.contact.y[i] = tip.y() - met.gap * met.ny;
      c.contact.z[i] = tip.z() - met.gap * met.nz;
      const bool away =
          met.faces == SurfacePoint::only_face && !(met.nx * axis.x() + met.ny * axis.y() + met.nz * axis.z() < 0.0);
      c.faces[i] = away ? 0.0 : met.faces;
    }
  }
}

}  // namespace slipbench
