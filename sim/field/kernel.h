// The vectorised passes of a field step. Columns are 32-byte aligned and `count` is a multiple of kernel::lanes.
#pragma once

#include <cmath>
#include <cstddef>

#include <Eigen/Core>

namespace slipbench::kernel {

inline constexpr std::size_t lanes = 4;

// Pass 1 against a plane: contact points, gaps [m] and whether the element's axis looks at the plane.
struct PlaneGap {
  Eigen::Matrix3d rotation;  // of the pad in the surface
  Eigen::Vector3d position;  // m
  bool axes_differ;          // else one check of axis_of_all stands for all
  Eigen::Vector3d axis_of_all;
  const double *tip_x, *tip_y, *tip_z, *axis_x, *axis_y, *axis_z;
  double *contact_x, *contact_y, *contact_z, *gap;
};
void plane_gap(const PlaneGap& pass, std::size_t count);

// Raw normal force [N] at a gap [m]: negative while apart, so that its zero is the instant of touch. `h` is the history of a rheology.
[[gnu::always_inline]] inline double raw_press(double gap, double k_normal, double h) {
  return k_normal * -gap + (gap < 0.0 ? h : 0.0);
}

// A slip of a step [m] shorter than this is the rounding of coordinates (up to a hundred metres), not motion: an element at rest on its
// cone sticks. Slower motion is not lost; the stretch gathers it until it is longer.
inline constexpr double shortest_slip = 1e-13;

// Pass 2: normal force, and return mapping onto the friction cone (field.h). mode: 0 detached, 1 stick, 2 slip.
struct Mapping {
  const double *contact_x, *contact_y, *contact_z, *normal_x, *normal_y, *normal_z;
  const double *gap, *k_normal, *k_tangential, *compliance, *mu_static, *mu_kinetic, *mode_before;
  const double *h_normal, *h_x, *h_y, *h_z;  // only with memory; compliance is 1/k_tangential [m/N]
  double *press, *anchor_x, *anchor_y, *anchor_z, *slip_x, *slip_y, *slip_z;
  double *force_x, *force_y, *force_z, *limit, *mode, *path;
};
void map(const Mapping& pass, bool plane, bool memory, std::size_t count);

// After the passes: what the surface does to every element, in the pad frame P.
struct PadView {
  Eigen::Matrix3d to_pad;  // rotation of the surface in the pad
  const double *normal_x, *normal_y, *normal_z, *gap, *press, *force_x, *force_y, *force_z;
  const double *contact_x, *contact_y, *contact_z, *anchor_x, *anchor_y, *anchor_z, *slip_x, *slip_y, *slip_z;
  double *pad_force_x, *pad_force_y, *pad_force_z;     // N
  double *deflection_x, *deflection_y, *deflection_z;  // m, deformed tip minus undeformed tip
  double *pad_slip_x, *pad_slip_y;                     // m
};
void view_from_pad(const PadView& pass, std::size_t count);

}  // namespace slipbench::kernel
