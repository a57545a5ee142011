// The touched surfaces: signed distance, outward normal, and the face that a pad's element meets.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <variant>

#include <Eigen/Core>

#include "sim/contact/surface/distance_grid.h"
#include "sim/core/vectorise.h"

namespace slipbench {

// All shapes are given in the surface frame S. `at(x, y, z, ax, ay, az)`: tip and element axis in
// S. Inside a shape with several faces the face met is the one through which the element entered:
// the nearest one backwards along the element's axis, not the nearest in distance, so that a pillar
// close to an edge presses on the top and not on the side. This follows from one position alone; a
// change of face during the motion is handled by Field::keep_energy.
//
// Box and Cylinder also take the length of the element's column [m]: the distance behind its tip at
// which the column is fixed to the pad. A column meets the first flat face that it enters, however
// thin the shape is behind that face, so an element goes on pressing on a card that is thinner than
// the element is deep, even with its undeformed tip beyond the far side. A length of 0 means that
// the column is unknown: a tip nearer to a face that it points out of than to the one by which it
// entered then meets nothing.

// Result of at() for one element, or for the elements of a vector (kernel::Lanes). met() has no
// branches on vectors, since the elements may be different cases, unless no element needs the
// branch; each case is computed in the order of the scalar branches.
template <class Real>
struct Met {
  Real gap, nx, ny, nz, faces;
};

template <class Real>
[[gnu::always_inline]] inline Real root_of(const Real& values) {
  if constexpr (std::is_same_v<Real, double>) {
    return std::sqrt(values);
  } else {
    Real roots;
    for (std::size_t lane = 0; lane < sizeof(Real) / sizeof(double); ++lane) roots[lane] = std::sqrt(values[lane]);
    return roots;
  }
}

// True if a condition holds for the element, or for any of several.
template <class Mask>
[[gnu::always_inline]] inline bool any_of(const Mask& mask) {
  if constexpr (std::is_same_v<Mask, bool> || std::is_same_v<Mask, int>) {
    return mask != 0;
  } else {
    return any(mask);
  }
}

// The half-space z <= 0.
struct Plane {
  [[nodiscard]] SurfacePoint at(double, double, double z, double, double, double az) const {
    return {az < 0.0 ? z : std::abs(z), 0.0, 0.0, 1.0};
  }
};

struct Sphere {
  double radius;  // m, centre at the origin

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const {
    const double r = std::sqrt(x * x + y * y + z * z);
    // the centre has no nearest point: no element there points at a face
    if (r == 0.0) return {radius, ax, ay, az};
    const double nx = x / r, ny = y / r, nz = z / r;
    const double gap = r - radius;
    return {nx * ax + ny * ay + nz * az < 0.0 ? gap : std::abs(gap), nx, ny, nz};
  }
};

struct Box {
  Eigen::Vector3d half;  // m, half extents along x, y, z; centre at the origin

  // `kThin`: is_thin(column).
  template <bool kThin, class Real>
  [[nodiscard, gnu::always_inline]] inline Met<Real> met(const Real (&p)[3], const Real (&a)[3], double column) const {
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
      Real looks[3], way_back = none, way_ahead = none, entry = none, exit = none;
      for (int k = 0; k < 3; ++k) {
        looks[k] = a[k] < 0.0 ? one : -one;  // the face of this pair that faces the element
        const Real slope = a[k] < 0.0 ? -a[k] : a[k];
        const Real back = slope == 0.0 ? none + infinite : (half[k] - looks[k] * p[k]) / slope;
        const Real ahead = slope == 0.0 ? none + infinite : (half[k] + looks[k] * p[k]) / slope;
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
      const auto looks_in = (way_back <= way_ahead) | (way_back <= column);
      const Real face = looks_in ? entry : exit;
      for (int k = 0; k < 3; ++k) {
        const auto here = face == static_cast<double>(k);
        const Real side = looks_in ? looks[k] : -looks[k];
        gap = here ? half[k] - side * p[k] : gap;
        faces = here ? face_bit(k, side) : faces;
        n[k] = here ? side : none;
      }
      gap = looks_in ? -gap : gap;
      faces = looks_in ? faces : none;
    }
    if (any_of(is_outside)) {
      const Real distance = root_of(distance2);
      for (int k = 0; k < 3; ++k) n[k] = is_outside ? (p[k] < 0.0 ? -outside[k] : outside[k]) / distance : n[k];
      gap = is_outside ? distance : gap;
      faces = is_outside ? beyond : faces;
      if constexpr (kThin) {
        // the tip is beyond the face opposite to the one by which its column entered
        for (int k = 0; k < 3; ++k) {
          const Real looks = a[k] < 0.0 ? one : -one, slope = a[k] < 0.0 ? -a[k] : a[k], depth = half[k] - looks * p[k];
          const Real lateral = distance2 - outside[k] * outside[k];
          const double thickness = 2.0 * half[k];
          const auto entered = enters_by(k, p, a, depth / slope);
          const auto through = (slope >= upright) & (lateral == 0.0) & (depth > thickness) & (depth <= column * slope) & entered;
          gap = through ? -depth : gap;
          for (int j = 0; j < 3; ++j) n[j] = through ? (j == k ? looks : none) : n[j];
          faces = through ? face_bit(k, looks) : faces;
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
      const double looks = a[k] < 0.0 ? 1.0 : -1.0, slope = std::abs(a[k]);
      if (slope == 0.0) {
        if (std::abs(p[k]) > half[k]) passage.from = infinite;
        continue;
      }
      passage.from = std::max(passage.from, (-half[k] - looks * p[k]) / slope);
      const double way = (half[k] - looks * p[k]) / slope;
      if (way < passage.way)
        passage = {passage.from, way, looks * Eigen::Vector3d::Unit(k), static_cast<unsigned>(face_bit(k, looks))};
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
    const Met<double> point = is_thin(column) ? met<true>(p, a, column) : met<false>(p, a, column);
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

// A cylinder with its axis along z of S.
struct Cylinder {
  double radius;       // m
  double half_length;  // m

  // `kThin`: is_thin(column).
  template <bool kThin, class Real>
  [[nodiscard, gnu::always_inline]] inline Met<Real> met(const Real (&p)[3], const Real (&a)[3], double column) const {
    const Real none{}, one = none + 1.0;
    const Real r = root_of(p[0] * p[0] + p[1] * p[1]);
    const Real way = r > 0.0 ? r : one;
    const Real nx = r > 0.0 ? p[0] / way : one, ny = r > 0.0 ? p[1] / way : none;
    const Real height = p[2] < 0.0 ? -p[2] : p[2];
    const Real side = r - radius, cap = height - half_length;
    const auto beside = side > 0.0, beyond = cap > 0.0;
    const Real end = p[2] < 0.0 ? -one : one,
               looks = a[2] < 0.0 ? one : -one;  // the nearer cap; the cap that faces the element

    const Real towards_side = -(nx * a[0] + ny * a[1]), towards_cap = a[2] < 0.0 ? -a[2] : a[2];
    const Real depth = half_length - looks * p[2];
    const auto by_side = (towards_side > 0.0) & (-side * towards_cap <= depth * towards_side);
    // It entered through the cap, unless it points out through the side and leaves there sooner.
    const auto by_cap = (depth * -towards_side <= -side * towards_cap) | (depth <= column * towards_cap);
    const Real behind_gap = by_cap ? -depth : -side, behind_z = by_cap ? looks : none,
               behind_faces = by_cap ? cap_bit(looks) : none;
    const Real inside_gap = by_side ? side : behind_gap, inside_z = by_side ? none : behind_z;
    const Real inside_faces = by_side ? none + side_bit : behind_faces;
    // factor of the side's normal for a tip inside
    const Real within = by_side ? one : (by_cap ? none : one);

    const Real past_gap = beyond ? cap : inside_gap, past_z = beyond ? end : inside_z;
    const Real past_faces = beyond ? cap_bit(end) : inside_faces, past = beyond ? none : within;
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
      nz = through ? looks : nz;
      faces = through ? cap_bit(looks) : faces;
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
    const Met<double> point = is_thin(column) ? met<true>(p, a, column) : met<false>(p, a, column);
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

// The points nearer than `radius` to the segment |z| <= half_length of the z axis.
struct Capsule {
  double radius;       // m
  double half_length;  // m, of the cylinder between the two half balls

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const {
    return Sphere{radius}.at(x, y, z - std::clamp(z, -half_length, half_length), ax, ay, az);
  }
};

// The points p with sum (p_k/half_k)^2 <= 1.
//
// The nearest point x of the surface satisfies p - x = t q with q_k = x_k/half_k^2, so x_k = p_k
// half_k^2/(half_k^2 + t), and t, the largest root of F(t) = sum (x_k/half_k)^2 = 1, has the sign
// of the distance (Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid,
// 2013). 1/sqrt(F) is concave and nearly straight (straight for a sphere), so Newton's steps for
// 1/sqrt(F) = 1 never pass the root, and a few suffice, as for the secular equation of a trust
// region (Conn, Gould & Toint, Trust-Region Methods, 2000, sec. 7.3).
struct Ellipsoid {
  Eigen::Vector3d half;  // m, half axes along x, y, z; centre at the origin

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const {
    const double p[3] = {x, y, z};
    const double least = half.minCoeff() * half.minCoeff();
    // Solved for s = t + least, so that the divisor is not lost in rounding near the pole at s = 0.
    double scaled[3], excess[3], s = 1e-16 * least;
    const double lowest = s;
    for (int k = 0; k < 3; ++k) {
      scaled[k] = half[k] * p[k];
      excess[k] = half[k] * half[k] - least;
      // one term of F is 1 here, so the root lies beyond
      s = std::max(s, std::abs(scaled[k]) - excess[k]);
    }
    // Up to rounding on the disc (or rod, or centre) with two or more nearest points: nothing is
    // met.
    if (s == lowest && !(newton_step(scaled, excess, s) > 0.0)) return {half.minCoeff(), ax, ay, az};
    // Newton's step from the surface, where most tips are
    s = std::max(s, least + newton_step(scaled, excess, least));
    double step = s;
    while (step > 1e-9 * s) {  // the error is then of the order of the step's square
      step = newton_step(scaled, excess, s);
      s += step;
    }
    double q[3], size2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      q[k] = p[k] / (s + excess[k]);
      size2 += q[k] * q[k];
    }
    const double size = std::sqrt(size2), nx = q[0] / size, ny = q[1] / size, nz = q[2] / size;
    const double gap = (s - least) * size;
    return {nx * ax + ny * ay + nz * az < 0.0 ? gap : std::abs(gap), nx, ny, nz};
  }

 private:
  // Returns Newton's step towards 1/sqrt(F) = 1. F = sum y^2 with y_k = scaled_k/(s +
  // excess_k); its slope is -2 sum y_k^2/(s + excess_k).
  static double newton_step(const double (&scaled)[3], const double (&excess)[3], double s) {
    double f = 0.0, slope = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double reach = 1.0 / (s + excess[k]), y = scaled[k] * reach;
      f += y * y;
      slope += y * y * reach;
    }
    return f * (std::sqrt(f) - 1.0) / slope;
  }
};

using Surface = std::variant<Plane, Box, Cylinder, Sphere, Capsule, Ellipsoid, DistanceGrid>;

}  // namespace slipbench
