// A cylinder (surface.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "sim/contact/surface/nearest_point.h"
#include "sim/contact/surface/surface_point.h"
#include "sim/core/vectorise.h"

namespace slipbench {

// A cylinder with its axis along z of S.
struct Cylinder {
  double radius;       // m
  double half_length;  // m

  // `kThin`: is_thin(column).
  template <bool kThin, class Real>
  [[nodiscard, gnu::always_inline]] inline NearestPoint<Real> nearest(const Real (&p)[3], const Real (&a)[3],
                                                                      double column) const {
    const Real none{}, one = none + 1.0;
    const Real r = root_of(p[0] * p[0] + p[1] * p[1]);
    const Real way = r > 0.0 ? r : one;
    const Real nx = r > 0.0 ? p[0] / way : one, ny = r > 0.0 ? p[1] / way : none;
    const Real height = p[2] < 0.0 ? -p[2] : p[2];
    const Real side = r - radius, cap = height - half_length;
    const auto beside = side > 0.0, beyond = cap > 0.0;
    const Real end = p[2] < 0.0 ? -one : one,
               facing = a[2] < 0.0 ? one : -one;  // the nearer cap; the cap that faces the element

    const Real towards_side = -(nx * a[0] + ny * a[1]), towards_cap = a[2] < 0.0 ? -a[2] : a[2];
    const Real depth = half_length - facing * p[2], ahead = 2.0 * half_length - depth;  // to the other cap
    // It entered through the side or the cap, unless it points out through the other cap (or, if
    // through the cap, through the side) and leaves there sooner.
    const auto by_side = (towards_side > 0.0) & (-side * towards_cap <= depth * towards_side) &
                         ((-side * towards_cap <= ahead * towards_side) | (-side <= column * towards_side));
    // Gap, normal and face of a tip that is not beside the cylinder, here for one that entered through
    // the side. `past`: factor of the side's normal.
    Real past_gap = side, past_z = none, past_faces = none + side_bit, past = one;
    if (any_of((beyond | !by_side) & !beside)) {
      const auto by_cap = ((depth * -towards_side <= -side * towards_cap) & (depth <= ahead)) | (depth <= column * towards_cap);
      const auto by_end = ahead * -towards_side <= -side * towards_cap;  // where it leaves, if it has not entered
      const Real behind_gap = by_cap ? -depth : (by_end ? ahead : -side);
      const Real behind_z = by_cap ? facing : (by_end ? -facing : none), behind_faces = by_cap ? cap_bit(facing) : none;
      past_gap = beyond ? cap : (by_side ? side : behind_gap);
      past_z = beyond ? end : (by_side ? none : behind_z);
      past_faces = beyond ? cap_bit(end) : (by_side ? past_faces : behind_faces);
      past = beyond ? none : (by_side ? one : ((by_cap | by_end) ? none : one));
    }
    Real out_gap = side, out_z = none, out = one;
    if (any_of(beside & beyond)) {  // rare, and a root and two quotients are expensive
      const Real corner = root_of(side * side + cap * cap);
      out_gap = beyond ? corner : side;
      out_z = beyond ? end * cap / corner : none;
      out = beyond ? side / corner : one;
    }
    const Real out_faces = beyond ? none + side_bit + cap_bit(end) : none + side_bit;
    Real share = beside ? out : past;
    Real gap = beside ? out_gap : past_gap, nz = beside ? out_z : past_z, faces = beside ? out_faces : past_faces;
    // the tip is beyond the cap opposite to the one by which its column entered
    if constexpr (kThin) {
      const auto through = (towards_cap >= upright) & (side <= 0.0) & (depth > 2.0 * half_length) &
                           (depth <= column * towards_cap) & enters_by_cap(p, a, depth / towards_cap);
      gap = through ? -depth : gap;
      share = through ? none : share;
      nz = through ? facing : nz;
      faces = through ? cap_bit(facing) : faces;
    }
    return {gap, share * nx, share * ny, nz, faces};
  }

  // True if a column of that length [m] may stick out of both caps.
  [[nodiscard]] bool is_thin(double column) const { return 2.0 * half_length < column; }

  // Returns the outward normal of the cap with a single bit of SurfacePoint::faces; 0 for the side,
  // several bits or none.
  [[nodiscard]] Eigen::Vector3d normal_of(unsigned faces) const {
    for (const double end : {1.0, -1.0}) {
      if (faces == static_cast<unsigned>(cap_bit(end))) return {0.0, 0.0, end};
    }
    return Eigen::Vector3d::Zero();
  }

  // Like Box::is_behind(), for a cap.
  [[nodiscard]] bool is_behind(unsigned faces, const Eigen::Vector3d& p, const Eigen::Vector3d& a) const {
    const double end = normal_of(faces).z(), slope = -end * a.z(), depth = half_length - end * p.z();
    const double tip[3] = {p.x(), p.y(), p.z()}, axis[3] = {a.x(), a.y(), a.z()};
    return slope > 0.0 && depth > half_length && enters_by_cap(tip, axis, 0.0) && enters_by_cap(tip, axis, depth / slope);
  }

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az, double column = 0.0) const {
    const double p[3] = {x, y, z}, a[3] = {ax, ay, az};
    const NearestPoint<double> point = is_thin(column) ? nearest<true>(p, a, column) : nearest<false>(p, a, column);
    return {point.gap, point.nx, point.ny, point.nz, static_cast<unsigned>(point.faces)};
  }

 private:
  static constexpr double upright = 0.5;  // like Box::upright
  static constexpr double side_bit = 2.0;

  // True if the column at the distance `way` behind the tip is within the edge of the caps.
  template <class Real>
  [[gnu::always_inline]] inline decltype(Real{} <= Real{})
      enters_by_cap(const Real (&p)[3], const Real (&a)[3], const Real& way) const {
    const Real x = p[0] - way * a[0], y = p[1] - way * a[1];
    return x * x + y * y <= radius * radius;
  }
  template <class Real>
  [[gnu::always_inline]] static inline Real cap_bit(const Real& end) {
    const Real none{};
    return end < 0.0 ? none + 8.0 : none + 4.0;
  }
};

}  // namespace slipbench
