// Contact points of a pad's elements on a surface.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <variant>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"
#include "sim/contact/kernel.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/pose.h"

namespace slipbench {

class ContactPoints {
 public:
  ContactPoints(const PadLayout& layout, const Surface& surface);

  // Writes contact points and gaps of the groups' elements with the pad at `pose` in the surface,
  // and their normals and faces unless the surface is a plane. On a plane `groups` must be all.
  void find(const kernel::Columns& columns, const Pose& pose, const kernel::Groups& groups) const;

  // True if the surface is a plane, so that all elements have the same normal.
  [[nodiscard]] bool on_plane() const { return std::holds_alternative<Plane>(surface_); }
  // True if all elements have the same axis.
  [[nodiscard]] bool flat_pad() const { return flat_pad_; }
  // True if the axes of a flat pad point towards the plane.
  [[nodiscard]] bool faces_plane(const Pose& pose) const { return pose.rotation.row(2).dot(axis_) < 0.0; }
  // Returns the contact of an element with the tip `tip` [m] and the unit vector `axis`, both in S.
  [[nodiscard]] SurfacePoint at(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) const;
  // True if a column may stick out of both sides of the surface. The gap of a tip beyond the far
  // side may then change by more than the tip moves.
  [[nodiscard]] bool is_thin() const;
  // Follows the straight line from a tip back along the axis to where it leaves the surface: at the
  // distance `way` behind the tip, through the face whose bit is `faces`, with the outward normal
  // n. Returns nothing if the line is not inside the surface at the distance `from` behind the tip
  // [m].
  struct Entry {
    double way;
    Eigen::Vector3d n;
    unsigned faces;
  };
  [[nodiscard]] std::optional<Entry> entry(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) const;
  // Returns the outward normal at a contact point of an element with this axis; `faces`: the face
  // met there.
  [[nodiscard]] Eigen::Vector3d normal_at(const Eigen::Vector3d& contact, const Eigen::Vector3d& axis, unsigned faces) const;
  // True if an element that has separated did not leave through the face that it pressed on, nor
  // beside the surface. `faces`, `depth`: its face and depth [m] in the last step; `met`: its
  // contact now.
  [[nodiscard]] bool has_come_through(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, unsigned faces, double depth,
                                      const SurfacePoint& met) const;
  // Distance behind its tip at which an element is fixed to the pad [m]; 0: unknown.
  [[nodiscard]] double column() const { return column_; }
  [[nodiscard]] bool on_grid() const { return std::holds_alternative<DistanceGrid>(surface_); }
  // True if the surface is a grid that knows which face an element entered.
  [[nodiscard]] bool knows_crossings() const {
    const DistanceGrid* const grid = std::get_if<DistanceGrid>(&surface_);
    return grid != nullptr && grid->knows_crossings();
  }
  // True if the tip of an element moved from `from` to `to` through a wall of a grid's surface, or
  // lost contact inside: `pressed_on` is the normal of the face that it pressed on at `from`, zero if
  // it was outside.
  [[nodiscard]] bool has_left_grid(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& axis,
                                   const Eigen::Vector3d& pressed_on) const;
  // True if the point p of S [m] is inside the surface.
  [[nodiscard]] bool is_inside(const Eigen::Vector3d& p) const;
  // True if the point p of S [m] is outside the surface; false where the gap's slope may exceed 1,
  // between the nodes of a grid.
  [[nodiscard]] bool is_outside(const Eigen::Vector3d& p) const;

 private:
  template <class Shape>
  void meet(const Shape& shape, const kernel::Columns& columns, const Pose& pose, const kernel::Groups& groups) const;

  // The column for a grid: a pad that points the wrong way is refused elsewhere (SiteWatch).
  [[nodiscard]] double column_in_grid() const { return column_ > 0.0 ? column_ : std::numeric_limits<double>::infinity(); }

  Surface surface_;
  std::size_t count_;
  Eigen::Vector3d axis_;  // of the first element, in P
  bool flat_pad_;
  double column_;  // m, length of an element behind its tip: the units' height, 0 if unknown
};

}  // namespace slipbench
