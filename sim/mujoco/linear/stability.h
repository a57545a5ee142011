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
// robot's size. linear_model.h has the limits of a step.
#pragma once

#include <span>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"
#include "sim/mujoco/linear/dense.h"
#include "sim/mujoco/linear/linear_model.h"

struct mjModel_;
struct mjData_;

namespace slipbench {

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

// `tangents` and `pads` go in pairs. Throws std::invalid_argument when the spans differ in length.
[[nodiscard]] Vibration fastest_vibration(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                          std::span<const PadTangent> tangents);

// No slower than that, and in a fifth of its time: the largest eigenvalue of a matrix P whose eigenvalues are real is sqrt(tr P^2) at most.
[[nodiscard]] Vibration vibration_bound(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                        std::span<const PadTangent> tangents);

// A model near the state of `d`, as far as its pads and its joints' dampers go. `tangents` and `pads` go in pairs. Springs of joints, tendons
// and actuators are not in it. Throws std::invalid_argument when the spans differ in length.
[[nodiscard]] LinearModel linear_model(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                       std::span<const PadTangent> tangents);

// That of the model's integrator: RK4, or one of one stage.
[[nodiscard]] Stepping stepping_of(const mjModel_* m);

}  // namespace slipbench
