// Where the elements of a pad meet a surface.
#pragma once

#include <cstddef>
#include <optional>
#include <variant>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/kernel.h"
#include "sim/field/surface/surface.h"

namespace slipbench {

class ContactPoints {
 public:
  ContactPoints(const PadLayout& layout, const Surface& surface);

  // Writes contact points and gaps of the groups' elements when the pad is at `pose` in the surface, and their normals and faces unless
  // the surface is a plane. On a plane `groups` are all.
  void find(const kernel::Columns& columns, const Pose& pose, const kernel::Groups& groups) const;

  // Whether the surface is a plane, so that all elements meet one normal.
  [[nodiscard]] bool on_plane() const { return std::holds_alternative<Plane>(surface_); }
  // Whether all elements have one axis.
  [[nodiscard]] bool flat_pad() const { return flat_pad_; }
  // Whether the axes of a flat pad look at the plane.
  [[nodiscard]] bool looks_at_plane(const Pose& pose) const { return pose.rotation.row(2).dot(axis_) < 0.0; }
  // Where an element with its tip at `tip` [m] and the unit vector `axis`, both in S, meets the surface.
  [[nodiscard]] SurfacePoint at(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis) const;
  // Returns true if a column may stick out of both sides of the surface. The gap of a tip beyond the far side may then change by more than the tip moves.
  [[nodiscard]] bool is_thin() const;
  // Where the straight line from a tip back along the axis leaves the surface, if it is in it at the distance `from` behind the tip [m]: at the
  // distance `way` behind the tip, through the face whose bit is `faces`, with the outward normal n there. Nothing if it is not in it there.
  struct Entry {
    double way;
    Eigen::Vector3d n;
    unsigned faces;
  };
  [[nodiscard]] std::optional<Entry> entry(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, double from) const;
  // The outward normal at the point of the surface that an element of this axis touched; `faces`: what it met there.
  [[nodiscard]] Eigen::Vector3d normal_at(const Eigen::Vector3d& contact, const Eigen::Vector3d& axis, unsigned faces) const;
  // True if an element that has let go did so without coming out by the face that it had pressed on or beside the surface. `faces`, `depth`: what
  // it met and how deep it was [m] in the step before; `met`: what it meets now.
  [[nodiscard]] bool has_come_through(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis, unsigned faces, double depth,
                                      const SurfacePoint& met) const;
  // How far behind its tip an element is fixed to the pad [m]; 0: not known.
  [[nodiscard]] double column() const { return column_; }
  [[nodiscard]] bool on_grid() const { return std::holds_alternative<DistanceGrid>(surface_); }
  // Returns true if the point p of S [m] is inside the surface.
  [[nodiscard]] bool is_inside(const Eigen::Vector3d& p) const;
  // Returns true if the point p of S [m] is outside the surface; false where the gap's slope may exceed 1: between the nodes of a grid.
  [[nodiscard]] bool is_outside(const Eigen::Vector3d& p) const;

 private:
  template <class Shape>
  void meet(const Shape& shape, const kernel::Columns& columns, const Pose& pose, const kernel::Groups& groups) const;

  Surface surface_;
  std::size_t count_;
  Eigen::Vector3d axis_;  // of the first element, in P
  bool flat_pad_;
  double column_;  // m, length of an element behind its tip: the units' height, 0 where it is not known
};

}  // namespace slipbench
