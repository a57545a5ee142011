// Field: where the elements meet the surface.
#include <algorithm>
#include <cmath>
#include <variant>

#include "sim/field/field.h"

namespace slipbench {

// Whether the axes of a flat pad look at the plane.
bool Field::looks_at_plane() const { return pose_.rotation.row(2).dot(layout_.elements.front().axis) < 0.0; }

void Field::find_contact_points() {
  if (on_plane()) {
    kernel::plane_gap(columns_, pose_, padded_);
    if (!flat_pad_ || !looks_at_plane()) kernel::turn_away(columns_, pose_, padded_);
    return;
  }
  keep_as_before(faces, faces_before);
  if (const Box* box = std::get_if<Box>(&surface_)) {
    kernel::meet_box(columns_, *box, pose_, padded_);
    return;
  }
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&surface_)) {
    kernel::meet_cylinder(columns_, *cylinder, pose_, padded_);
    return;
  }
  std::visit([this](const auto& shape) { meet(shape, columns_, pose_, kernel::Groups{nullptr, 1}, count_); }, surface_);
}

void Field::find_contact_points(const kernel::Columns& columns, const Pose& pose, const kernel::Groups& groups) const {
  if (const Box* box = std::get_if<Box>(&surface_)) {
    kernel::meet_box(columns, *box, pose, groups);
    return;
  }
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&surface_)) {
    kernel::meet_cylinder(columns, *cylinder, pose, groups);
    return;
  }
  std::visit([&](const auto& shape) { meet(shape, columns, pose, groups, kernel::lanes); }, surface_);
}

// Of groups of `entries`.
template <class Shape>
void Field::meet(const Shape& shape, const kernel::Columns& columns, const Pose& at, const kernel::Groups& groups,
                 std::size_t entries) const {
  // Copies: the compiler cannot know that what is written to the columns is none of these.
  const kernel::Columns c = columns;
  const Pose pose = at;
  const Shape met_by = shape;  // NOLINT(performance-unnecessary-copy-initialization)
  Eigen::Vector3d axis = pose.rotation * vector(kernel::axis_x, 0);
  for (std::size_t k = 0; k < groups.count; ++k) {
    const std::size_t first = groups[k], end = std::min(count_, first + entries);
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
