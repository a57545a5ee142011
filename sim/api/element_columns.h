// Columns of the element field that an effect reads and writes.
#pragma once

#include <cstddef>

namespace slipbench {

// Read-only columns of a field with `count` elements, in the surface frame S. Entries beyond
// `count`, up to a multiple of kernel::lanes, exist but are undefined.
struct ElementColumns {
  std::size_t count;
  double dt;  // s, 0 in the first step
  // Contact point of the tip [m], see SurfaceEffect.
  const double *x, *y, *z;
  const double *nx, *ny, *nz;  // unit outward normal of the surface
  const double* penetration;   // m, >= 0
  const double* normal_force;  // N
  const double *vx, *vy, *vz;  // velocity of the undeformed tip over the surface, tangential [m/s]
  const double* mode;          // state after the last step: 0 detached, 1 stick, 2 slip
};

// Coefficients of an element's force (RheologyEffect). The force of a step is affine in the
// deflection at its end, f = k u + h, for the normal direction (deflection: penetration) and for
// the three components of the tangential one.
struct AffineForce {
  double *k_normal, *h_normal;             // [N/m], [N]
  double *k_tangential, *h_x, *h_y, *h_z;  // [N/m], [N], [N], [N]
};

// Columns of a field on the plane z = 0 of S for tips with mass, one entry per element. All vectors
// are tangential. "root": the contact point of the undeformed element, which carries the tip by
// spring and dashpot. The entries from `count` to `padded`, a multiple of kernel::lanes, never
// touch.
struct TipColumns {
  std::size_t count, padded;
  double dt;                                  // s, 0 in the first step
  const double *x, *y, *x_before, *y_before;  // root at the end and at the start of the step [m]
  // raw normal force [N], negative while separated: linear in the step
  const double *f_normal, *f_normal_before;
  const double *limit, *limit_before;  // mu_s f_n [N]: linear in the step
  // [1]; 0 detached, 1 stick, 2 slip
  const double *mu_kinetic, *mode_before;
  double *tip_x, *tip_y;  // position of the tip [m]: in at the start of the step, out at its end
  // Displacement of the touching tip over the surface in the step [m]; its accumulated length [m].
  double *slip_x, *slip_y, *path;
  // Force of the tip on the surface; of spring and dashpot on the tip [N].
  double *friction_x, *friction_y, *transmitted_x, *transmitted_y;
  double* mode;  // at the end of the step
};

}  // namespace slipbench
