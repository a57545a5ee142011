// The touched surfaces: analytic signed distance, outward normal, and which face a pad's element meets.
#pragma once

#include <cmath>
#include <limits>
#include <variant>

#include <Eigen/Core>

namespace slipbench {

// What an element meets: `gap` is the signed distance of its undeformed tip [m] (negative: penetration), `normal` the unit outward
// normal of the surface there. An element whose axis points away from every face near it never touches: its gap is positive.
struct SurfacePoint {
  double gap;
  double nx, ny, nz;
};

// All shapes are given in the surface frame S. `at(x, y, z, ax, ay, az)`: tip and element axis in S.
// Inside a shape with several faces the face met is the one through which the element entered: the nearest one seen backwards along
// the element's axis, not the nearest in distance, so that a pillar close to an edge presses on the top and not on the side.

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
    if (r == 0.0) return {radius, -ax, -ay, -az};  // the centre has no nearest point
    const double nx = x / r, ny = y / r, nz = z / r;
    const double gap = r - radius;
    return {nx * ax + ny * ay + nz * az < 0.0 ? gap : std::abs(gap), nx, ny, nz};
  }
};

struct Box {
  Eigen::Vector3d half;  // m, half extents along x, y, z; centre at the origin

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const {
    const double p[3] = {x, y, z};
    const double a[3] = {ax, ay, az};
    double outside[3];
    double n[3] = {0.0, 0.0, 0.0};
    double distance2 = 0.0;
    for (int k = 0; k < 3; ++k) {
      outside[k] = std::max(0.0, std::abs(p[k]) - half[k]);
      distance2 += outside[k] * outside[k];
    }
    if (distance2 > 0.0) {
      const double distance = std::sqrt(distance2);
      for (int k = 0; k < 3; ++k) n[k] = std::copysign(outside[k], p[k]) / distance;
      return {distance, n[0], n[1], n[2]};
    }
    int entry = 0, exit = 0;
    double way_back = std::numeric_limits<double>::infinity(), way_ahead = way_back;
    for (int k = 0; k < 3; ++k) {
      if (a[k] == 0.0) continue;
      const double sign = a[k] < 0.0 ? 1.0 : -1.0;  // the face of this pair that looks at the element
      const double back = (half[k] - sign * p[k]) / std::abs(a[k]), ahead = (half[k] + sign * p[k]) / std::abs(a[k]);
      if (back < way_back) way_back = back, entry = k;
      if (ahead < way_ahead) way_ahead = ahead, exit = k;
    }
    const bool looks_in = way_back <= way_ahead;  // else it looks out through a nearer face than it could have come in by
    const int face = looks_in ? entry : exit;
    const double sign = (a[face] < 0.0) == looks_in ? 1.0 : -1.0;
    const double depth = half[face] - sign * p[face];
    n[face] = sign;
    return {looks_in ? -depth : depth, n[0], n[1], n[2]};
  }
};

// Axis along z of S.
struct Cylinder {
  double radius;       // m
  double half_length;  // m

  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const {
    const double r = std::hypot(x, y);
    const double nx = r > 0.0 ? x / r : 1.0, ny = r > 0.0 ? y / r : 0.0;
    const double side = r - radius, cap = std::abs(z) - half_length;
    if (side > 0.0 && cap > 0.0) {
      const double distance = std::hypot(side, cap);
      return {distance, nx * side / distance, ny * side / distance, std::copysign(cap, z) / distance};
    }
    const double nz = az < 0.0 ? 1.0 : -1.0;  // the cap that looks at the element
    if (side > 0.0) return {side, nx, ny, 0.0};
    if (cap > 0.0) return {cap, 0.0, 0.0, std::copysign(1.0, z)};
    const double towards_side = -(nx * ax + ny * ay), towards_cap = std::abs(az);
    const double cap_depth = half_length - nz * z;
    if (towards_side > 0.0 && -side * towards_cap <= cap_depth * towards_side) return {side, nx, ny, 0.0};
    // It came in through the cap, unless it looks out through the side and leaves by it sooner.
    if (cap_depth * -towards_side <= -side * towards_cap) return {-cap_depth, 0.0, 0.0, nz};
    return {-side, nx, ny, 0.0};
  }
};

using Surface = std::variant<Plane, Box, Cylinder, Sphere>;

}  // namespace slipbench
