#include "sim/field/contact_points.h"

#include <algorithm>
#include <cmath>

namespace slipbench {
namespace {

bool outside(const Plane& /*shape*/, const Eigen::Vector3d& p) { return p.z() > 0.0; }
bool outside(const Sphere& shape, const Eigen::Vector3d& p) { return p.norm() > shape.radius; }
bool outside(const Box& shape, const Eigen::Vector3d& p) { return (p.cwiseAbs() - shape.half).maxCoeff() > 0.0; }
bool outside(const Cylinder& shape, const Eigen::Vector3d& p) {
  return std::hypot(p.x(), p.y()) > shape.radius || std::abs(p.z()) > shape.half_length;
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

// A grid tells the side by the sign of the gap of one of two opposite axes.
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
    if (!flat_pad_ || !looks_at_plane(pose)) kernel::turn_away(columns, pose, groups.count * kernel::lanes);
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
  // Copies: the compiler cannot know that what is written to the columns is none of these.
  const kernel::Columns c = columns;
  const Pose pose = at;
  const Shape met_by = shape;  // NOLINT(performance-unnecessary-copy-initialization)
  Eigen::Vector3d axis = pose.rotation * axis_;
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t first = groups[k], end = std::min(count_, first + kernel::lanes);
    for (std::size_t i = first; i < end; ++i) {
      const Eigen::Vector3d tip = pose * Eigen::Vector3d(c[kernel::tip_x][i], c[kernel::tip_y][i], c[kernel::tip_z][i]);
      if (!flat_pad_) axis = pose.rotation * Eigen::Vector3d(c[kernel::axis_x][i], c[kernel::axis_y][i], c[kernel::axis_z][i]);
      const SurfacePoint met = met_by.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z());
      c[kernel::gap][i] = met.gap;
      c[kernel::normal_x][i] = met.nx;
      c[kernel::normal_y][i] = met.ny;
      c[kernel::normal_z][i] = met.nz;
      c[kernel::contact_x][i] = tip.x() - met.gap * met.nx;
      c[kernel::contact_y][i] = tip.y() - met.gap * met.ny;
      c[kernel::contact_z][i] = tip.z() - met.gap * met.nz;
      const bool away =
          met.faces == SurfacePoint::only_face && !(met.nx * axis.x() + met.ny * axis.y() + met.nz * axis.z() < 0.0);
      c[kernel::faces][i] = away ? 0.0 : met.faces;
    }
  }
}

}  // namespace slipbench
