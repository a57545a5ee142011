// Shapes without edges: sphere, capsule, ellipsoid (surface.h).
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "sim/contact/surface/surface_point.h"

namespace slipbench {

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
// of the distance [eberly2013]. 1/sqrt(F) is concave and nearly straight (straight for a sphere),
// so Newton's steps for 1/sqrt(F) = 1 never pass the root, and a few suffice, as for the secular
// equation of a trust region ([conn2000], sec. 7.3).
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

}  // namespace slipbench
