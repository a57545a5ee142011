// A box (surface.h).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include <Eigen/Core>

#include "sim/contact/surface/nearest_point.h"
#include "sim/contact/surface/surface_point.h"
#include "sim/core/vectorise.h"

namespace slipbench {

struct Box {
  Eigen::Vector3d half;  // m, half extents along x, y, z; centre at the origin

  // `kThin`: is_thin(column). A single long function, because its parts share ten vectors that must
  // stay in registers.
  template <bool kThin, class Real>
  [[nodiscard, gnu::always_inline]] inline NearestPoint<Real> nearest(const Real (&p)[3], const Real (&a)[3],
                                                                      double column) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const Real none{}, one = none + 1.0;
    Real outside[3], sides[3], distance2 = none, beyond = none;
    for (int k = 0; k < 3; ++k) {
      const Real excess = (p[k] < 0.0 ? -p[k] : p[k]) - half[k];
      outside[k] = excess > 0.0 ? excess : none;
      distance2 += outside[k] * outside[k];
      sides[k] = p[k] < 0.0 ? -one : one;
      beyond += excess > 0.0 ? face_bit(k, sides[k]) : none;
    }

    Real n[3] = {none, none, none}, gap = none, faces = none;
    const auto is_outside = distance2 > 0.0;
    if (any_of(!is_outside)) {
      Real facing[3], way_back = none, way_ahead = none, entry = none, exit = none;
      for (int k = 0; k < 3; ++k) {
        facing[k] = a[k] < 0.0 ? one : -one;  // the face of this pair that faces the element
        const Real slope = a[k] < 0.0 ? -a[k] : a[k];
        const Real back = slope == 0.0 ? none + infinite : (half[k] - facing[k] * p[k]) / slope;
        const Real ahead = slope == 0.0 ? none + infinite : (half[k] + facing[k] * p[k]) / slope;
        if (k == 0) {
          way_back = back;
          way_ahead = ahead;
          continue;
        }
        entry = back < way_back ? none + k : entry;
        way_back = back < way_back ? back : way_back;
        exit = ahead < way_ahead ? none + k : exit;
        way_ahead = ahead < way_ahead ? ahead : way_ahead;
      }
      // Otherwise it points out through a face nearer than the one by which it could have entered.
      const auto by_entry = (way_back <= way_ahead) | (way_back <= column);
      const Real face = by_entry ? entry : exit;
      for (int k = 0; k < 3; ++k) {
        const auto here = face == static_cast<double>(k);
        const Real side = by_entry ? facing[k] : -facing[k];
        gap = here ? half[k] - side * p[k] : gap;
        faces = here ? face_bit(k, side) : faces;
        n[k] = here ? side : none;
      }
      gap = by_entry ? -gap : gap;
      faces = by_entry ? faces : none;
    }
    if (any_of(is_outside)) {
      const Real distance = root_of(distance2);
      for (int k = 0; k < 3; ++k) n[k] = is_outside ? (p[k] < 0.0 ? -outside[k] : outside[k]) / distance : n[k];
      gap = is_outside ? distance : gap;
      faces = is_outside ? beyond : faces;
      if constexpr (kThin) {
        // the tip is beyond the face opposite to the one by which its column entered
        for (int k = 0; k < 3; ++k) {
          const Real facing = a[k] < 0.0 ? one : -one, slope = a[k] < 0.0 ? -a[k] : a[k], depth = half[k] - facing * p[k];
          const Real lateral = distance2 - outside[k] * outside[k];
          const double thickness = 2.0 * half[k];
          const auto entered = enters_by(k, p, a, depth / slope);
          const auto through = (slope >= upright) & (lateral == 0.0) & (depth > thickness) & (depth <= column * slope) & entered;
          gap = through ? -depth : gap;
          for (int j = 0; j < 3; ++j) n[j] = through ? (j == k ? facing : none) : n[j];
          faces = through ? face_bit(k, facing) : faces;
        }
      }
    }
    return {gap, n[0], n[1], n[2], faces};
  }

  // True if a column of that length [m] may stick out of both sides.
  [[nodiscard]] bool is_thin(double column) const { return 2.0 * half.minCoeff() < column; }

  // Returns the outward normal of the face with a single bit of SurfacePoint::faces; 0 for several
  // bits or none.
  [[nodiscard]] Eigen::Vector3d normal_of(unsigned faces) const {
    for (int k = 0; k < 3; ++k) {
      for (const double side : {1.0, -1.0}) {
        if (faces == static_cast<unsigned>(face_bit(k, side))) return side * Eigen::Vector3d::Unit(k);
      }
    }
    return Eigen::Vector3d::Zero();
  }

  // The straight line from the tip back along the axis leaves the box at the distance `way` behind
  // the tip [m], through the face with the bit `faces` and the normal n; it is in the box from the
  // distance `from` on [m].
  struct Passage {
    double from, way;
    Eigen::Vector3d n;
    unsigned faces;
  };
  [[nodiscard]] Passage passage(const Eigen::Vector3d& p, const Eigen::Vector3d& a) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Passage passage{-infinite, infinite, Eigen::Vector3d::Zero(), 0};
    for (int k = 0; k < 3; ++k) {
      const double facing = a[k] < 0.0 ? 1.0 : -1.0, slope = std::abs(a[k]);
      if (slope == 0.0) {
        if (std::abs(p[k]) > half[k]) passage.from = infinite;
        continue;
      }
      passage.from = std::max(passage.from, (-half[k] - facing * p[k]) / slope);
      const double way = (half[k] - facing * p[k]) / slope;
      if (way < passage.way)
        passage = {passage.from, way, facing * Eigen::Vector3d::Unit(k), static_cast<unsigned>(face_bit(k, facing))};
    }
    return passage;
  }

  // True if an element that pressed on the face with the bit `faces` is past the middle behind that
  // face, with neither its tip nor its column beyond the edges of the face.
  [[nodiscard]] bool is_behind(unsigned faces, const Eigen::Vector3d& p, const Eigen::Vector3d& a) const {
    const Eigen::Vector3d n = normal_of(faces);
    const double slope = -n.dot(a);
    if (!(slope > 0.0)) return false;
    Eigen::Index k = 0;
    n.cwiseAbs().maxCoeff(&k);
    const double depth = half[k] - n.dot(p), tip[3] = {p.x(), p.y(), p.z()}, axis[3] = {a.x(), a.y(), a.z()};
    const int pair = static_cast<int>(k);
    return depth > half[k] && enters_by(pair, tip, axis, 0.0) && enters_by(pair, tip, axis, depth / slope);
  }

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az, double column = 0.0) const {
    const double p[3] = {x, y, z}, a[3] = {ax, ay, az};
    const NearestPoint<double> point = is_thin(column) ? nearest<true>(p, a, column) : nearest<false>(p, a, column);
    return {point.gap, point.nx, point.ny, point.nz, static_cast<unsigned>(point.faces)};
  }

 private:
  // Least cosine between the axis of an element and the normal of a face through whose whole
  // thickness its column passes: 60 deg.
  static constexpr double upright = 0.5;

  // True if the column at the distance `way` behind the tip is within the edges of the faces of
  // pair k.
  template <class Real>
  [[gnu::always_inline]] inline decltype(Real{} <= Real{})
      enters_by(int k, const Real (&p)[3], const Real (&a)[3], const Real& way) const {
    const int u = (k + 1) % 3, v = (k + 2) % 3;
    const Real x = p[u] - way * a[u], y = p[v] - way * a[v];
    const double width = half[u], length = half[v];
    return (x <= width) & (x >= -width) & (y <= length) & (y >= -length);
  }

  // Bits above only_face, which stands for surfaces without edges. `side`: 1 or -1.
  template <class Real>
  [[gnu::always_inline]] static inline Real face_bit(int k, const Real& side) {
    return (3.0 - side) * static_cast<double>(1U << (2 * k));
  }
};

}  // namespace slipbench
