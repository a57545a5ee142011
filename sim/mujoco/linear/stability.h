// Vibration frequencies of a field on the bodies that it connects, and the longest step of an
// explicit force.
//
// A pad's field is a spring between two bodies. About a point p its tangent is a symmetric 6x6
// matrix, translation first, world axes:
//   K = sum over elements of G' (k_n n n' + rho k_t (P - rho_s e e')) G,
//   G = [1, -[c - p]x],  P = 1 - n n'
// with the contact point c, the surface normal n and the tangential trial force s e. While the
// element sticks rho = 1, rho_s = 0. While it slips rho = mu_k f_n / s, rho_s = 1: it is free along
// e, and across e its force rotates, which is as stiff as sticking if s is near the cone; a rate
// law leaves the share Field::sliding_share() of k_t along e. A separated element adds nothing.
// (The increase of friction with f_n, mu_k k_n e n', is not symmetric and not in K.)
//
// All fields together, on bodies of joint-space inertia M, obey M q'' = -sum_p J_p' K_p J_p q with
// J_p the Jacobian of the pad's velocity relative to the object at p. The non-zero omega^2 are the
// eigenvalues of R A R', with K = R'R block by block and the Delassus matrix A = J M^-1 J', and are
// computed in this form: it has six rows per pad, whatever the robot's size. The limits of a step
// are given in linear_model.h.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"
#include "sim/contact/field.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/linear_model.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// A pad's field linearised about a point, in world axes, translation before rotation.
struct PadTangent {
  Matrix6d stiffness = Matrix6d::Zero();  // [N/m], [N], [N m]
  Matrix6d damping = Matrix6d::Zero();    // the same per 1/s
};

// Returns the greatest stiffness of a pad: every element sticks, with its surface normal along its
// axis. `pad`: pad frame in the world. Damping is that of the elements' dashpots and of those of
// Field::damped_wrench_on_pad(), `viscous_time` k [s].
[[nodiscard]] PadTangent stuck_tangent(const PadLayout& layout, const Pose& pad, const Eigen::Vector3d& point,
                                       double viscous_time);

// Returns the tangent of a field after its last step. `surface`: surface frame in the world.
// Includes springs and dashpots (for a slipping element those of viscous_time only along the
// normal, as in Field), but not the stiffness that a rheology effect adds.
[[nodiscard]] PadTangent field_tangent(const Field& field, const Pose& surface, const Eigen::Vector3d& point,
                                       double viscous_time);

// Pad and object as MuJoCo body ids (0, the world, is fixed), and the world point at which
// velocities are compared.
struct PadOnBodies {
  int pad_body;
  int object_body;
  Eigen::Vector3d point;
};

// Pads, and the tangent of each.
struct PadTangents {
  std::vector<PadOnBodies> bodies;
  std::vector<PadTangent> tangents;
};

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Writes [6, nv] to `rows`, row-major: velocity of the pad relative to the object at the point,
// translation before rotation. `d` must have been through mj_fwdPosition, as everywhere below.
void relative_jacobian(ModelView m, DataView d, const PadOnBodies& pad, double* rows);

// Returns J M^-1 J' [n, n] of the Jacobians [n, nv]. (mj_solveM requires a writable `d`; nothing
// outside its stack changes.)
[[nodiscard]] Eigen::MatrixXd delassus(ModelView m, DataView d, const RowMatrix& jacobians);

// Returns the fastest mode. `tangents` and `pads` go in pairs. Throws std::invalid_argument if the
// spans differ in length.
[[nodiscard]] Vibration fastest_vibration(ModelView m, DataView d, std::span<const PadOnBodies> pads,
                                          std::span<const PadTangent> tangents);

// Returns an upper bound of that, in a fifth of its time: the largest eigenvalue of a matrix P with
// real eigenvalues is at most sqrt(tr P^2).
[[nodiscard]] Vibration vibration_bound(ModelView m, DataView d, std::span<const PadOnBodies> pads,
                                        std::span<const PadTangent> tangents);

// Linearises a model near the state of `d`: its pads and its joints' dampers. Springs of joints,
// tendons and actuators are not included. `tangents` and `pads` go in pairs. Throws
// std::invalid_argument if the spans differ in length.
[[nodiscard]] LinearModel linear_model(ModelView m, DataView d, std::span<const PadOnBodies> pads,
                                       std::span<const PadTangent> tangents);

// Returns the stepping of the model's integrator.
[[nodiscard]] Stepping stepping_of(ModelView m);

}  // namespace slipbench
