// How fast a field vibrates on the bodies it joins, and the longest step that an explicit force may take.
//
// A pad's field is a spring between two bodies. About a point p its tangent is a symmetric 6x6 matrix, translation first, world
// axes:
//   K = sum over elements of G' (k_n n n' + rho k_t (P - rho_s e e')) G,   G = [1, -[c - p]x],  P = 1 - n n'
// with the contact point c, the surface normal n and the tangential trial force s e: rho = 1, rho_s = 0 while the element sticks,
// once it slips rho = mu_k f_n / s, rho_s = 1: it is free along e, and across it turns its force, which is as stiff as sticking
// when s is near the cone; a rate law leaves the share Field::sliding_share() of k_t along e. An element that is apart adds nothing.
// (What friction gains with f_n, mu_k k_n e n', is not symmetric and not in K.)
//
// All fields together, on bodies of joint-space inertia M, obey M q'' = -sum_p J_p' K_p J_p q with J_p the Jacobian of the pad's
// velocity relative to the object at p. The non-zero omega^2 of that are the eigenvalues of R A R', with K = R'R block by block
// and the Delassus matrix A = J M^-1 J', which is how they are computed here: as many rows as six times the pads, whatever the
// robot's size.
//
// Explicit limit. One mode with a viscous time tau (c = tau k), stepped as MuJoCo does it (velocity first, position with the new
// one):
//   v' = v - h (omega^2 x + tau omega^2 v),  x' = x + h v'
// With y = x/h, a = (h omega)^2, b = h tau omega^2 the map of (v, y) has trace 2 - a - b and determinant 1 - b, so by Jury's
// conditions it is stable exactly when b < 2 and a + 2 b < 4 (the second implies the first):
//   h omega < sqrt(4 + (tau omega)^2) - tau omega                                                             (2 without damping)
// Stable is not yet accurate: near the limit a slide comes out wrong (shared MUJOCO.md, section B). Right to 0.05 % is a step
// with
//   h omega <= 0.75  and  h tau omega^2 <= 1, the second so that damping never turns a velocity round within one step.
#pragma once

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

// A pad's field linearised about a point, in world axes, translation before rotation.
struct PadTangent {
  Matrix6d stiffness = Matrix6d::Zero();  // [N/m], [N], [N m]
  Matrix6d damping = Matrix6d::Zero();    // the same per 1/s
};

// The stiffest that a pad can be: every element sticks, its surface normal along its axis. `pad`: pad frame in the world. Damping
// is that of the elements' dashpots and of those of Field::damped_wrench_on_pad(), `viscous_time` k [s].
[[nodiscard]] PadTangent stuck_tangent(const PadLayout& layout, const Pose& pad, const Eigen::Vector3d& point,
                                       double viscous_time);

// A field as its last step left it. `surface`: surface frame in the world. Sees springs and dashpots (of a slipping element those
// of viscous_time only along the normal, as in Field); what a rheology effect or a leaning column adds to the stiffness is not
// in it.
[[nodiscard]] PadTangent field_tangent(const Field& field, const Pose& surface, const Eigen::Vector3d& point,
                                       double viscous_time);

// Pad and object as MuJoCo body ids (0, the world, stands still), and the world point where the pad's velocity is compared.
struct PadOnBodies {
  int pad_body;
  int object_body;
  Eigen::Vector3d point;
};

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// [6, nv] at `rows`, row-major: velocity of the pad relative to the object at the point, translation before rotation. `d` must
// have been through mj_fwdPosition, as everywhere below.
void relative_jacobian(const mjModel_* m, const mjData_* d, const PadOnBodies& pad, double* rows);

// J M^-1 J' [n, n] of the Jacobians [n, nv]. (mj_solveM wants `d` to be writable; nothing outside its stack changes.)
[[nodiscard]] Eigen::MatrixXd delassus(const mjModel_* m, mjData_* d, const RowMatrix& jacobians);

// The fastest mode of all pads together.
struct Vibration {
  double omega = 0.0;         // rad/s, natural frequency; 0: nothing vibrates
  double damping_rate = 0.0;  // 1/s, largest eigenvalue of M^-1 J' C J; tau omega^2 for a viscous time tau
};
// `tangents` and `pads` go in pairs. Throws std::invalid_argument when the spans differ in length.
[[nodiscard]] Vibration fastest_vibration(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                          std::span<const PadTangent> tangents);

// The longest step [s] at which an explicit force is right (see above): min(0.75/omega, 1/damping_rate); infinite when nothing
// vibrates.
[[nodiscard]] double longest_explicit_step(const Vibration& vibration);

// The step [s] beyond which one mode with `viscous_time` [s] diverges under an explicit force; infinite when omega is 0.
[[nodiscard]] double divergence_step(double omega, double viscous_time);

}  // namespace slipbench
