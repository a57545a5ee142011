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
// are given below.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/api/pad_layout.h"
#include "sim/contact/field.h"
#include "sim/core/pose.h"

struct mjData_;
struct mjModel_;

namespace slipbench {

// The longest steps of a linear model: stable, and accurate. This code does not use MuJoCo, so it
// is compiled once for all versions.
//
// Divergence of an explicit step. With the pads' stiffness K and damping C (their dashpots, of any
// pad) and the dampers D of the model's joints
//   M q'' = -K q - (C + D) q'.
// MuJoCo's one-stage integrators take the velocity first and the position with the new velocity,
// and dampers of joints implicitly (except Euler if the model disables that with `eulerdamp`: then
// they are as explicit as C, and belong there):
//   (M + h D) (v' - v) = -h (K x + C v + D v),  x' = x + h v'
// A mode that grows by the factor l per step has v = (l - 1)/(h l) x, and with m, k, c, d the
// quadratic forms of M, K, C, D in its shape x
//   (m + h d) (l - 1)^2 + h (c + d) (l - 1) + h^2 k l = 0
// With real m, k, c, d, which symmetric matrices give also for a complex x, Jury's conditions say
// that |l| <= 1 as long as h^2 k + 2 h c <= 4 m + 2 h d (then h (c + d) <= 2 (m + h d) as well),
// and at equality l = -1 is a root. So for any number of modes with any damping the limit is the
// least h with
//   largest eigenvalue of (M + h D/2)^-1 (h^2 K + 2 h C) = 4
// For one mode with a viscous time tau (c = tau k) it is h omega = sqrt(4 + (tau omega)^2) - tau
// omega, 2 without damping. With RK4 all is explicit: with l the roots of l^2 M + l (C + D) + K,
// the limit is the least h with |R(h l)| = 1 for one of them, R(z) = 1 + z + z^2/2 +
// z^3/6 + z^4/24: h omega = sqrt(8) without damping, h |l| = 2.785 if it is strong.
//
// A stable step need not be accurate: near the limit a slide is wrong (shared MUJOCO.md, section
// B). A step is accurate to 0.05 % with
//   h omega <= 0.75  and  h tau omega^2 <= 1,
// the second so that damping never reverses a velocity within one step.

// Factors of dense matrices, without MuJoCo, so that they are compiled once for all versions: each
// of Eigen's factorisations takes seconds to compile.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Returns the matrix of r x.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d cross;
  cross << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return cross;
}

// A symmetric matrix as a sum of squares: K = sum_k scale_k values_k values_k'. Terms that are only
// rounding have the scale 0.
struct Squares {
  std::array<double, 6> scale;
  Matrix6d values;  // columns
};
[[nodiscard]] Squares squares(const Matrix6d& k);

// Returns R of K = R'R, for K positive semi-definite up to rounding.
[[nodiscard]] Matrix6d root(const Matrix6d& k);

// Returns x of A x = b. [n, n], [n]; A must be regular.
[[nodiscard]] Eigen::VectorXd solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// The fastest mode of a model.
struct Vibration {
  double omega = 0.0;  // rad/s, natural frequency; 0: nothing vibrates
  // 1/s, largest eigenvalue of M^-1 C; tau omega^2 for a viscous time tau
  double damping_rate = 0.0;
};

// Returns the longest step [s] at which an explicit force is accurate (see above): min(0.75/omega,
// 1/damping_rate); infinite if nothing vibrates.
[[nodiscard]] double longest_explicit_step(const Vibration& vibration);

// A model linearised near a state. [nv, nv]
struct LinearModel {
  Eigen::MatrixXd mass;
  Eigen::MatrixXd stiffness;      // K
  Eigen::MatrixXd damping;        // C, and joints' dampers that the integrator takes explicitly
  Eigen::MatrixXd joint_damping;  // D
};

// How an integrator steps: the velocity first and the position with the new velocity, or RK4.
enum class Stepping { velocity_first, runge_kutta };

// Returns the step [s] beyond which the model diverges under explicit pads (see above), less 1 %:
// the tangents neglect that loads rotate with the surface, which makes 0.3 % where soft pads are
// indented by a fifth of their pitch (tools/cost/stability_map.h). Infinite if nothing
// vibrates.
[[nodiscard]] double divergence_step(const LinearModel& model, Stepping stepping);

// Returns the largest eigenvalue of a symmetric matrix.
[[nodiscard]] double largest_eigenvalue(const Eigen::MatrixXd& a);

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
// normal, as in Field), but not the stiffness that a rheology effect or a leaning column adds.
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
void relative_jacobian(const mjModel_* m, const mjData_* d, const PadOnBodies& pad, double* rows);

// Returns J M^-1 J' [n, n] of the Jacobians [n, nv]. (mj_solveM requires a writable `d`; nothing
// outside its stack changes.)
[[nodiscard]] Eigen::MatrixXd delassus(const mjModel_* m, mjData_* d, const RowMatrix& jacobians);

// Returns the fastest mode. `tangents` and `pads` go in pairs. Throws std::invalid_argument if the
// spans differ in length.
[[nodiscard]] Vibration fastest_vibration(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                          std::span<const PadTangent> tangents);

// Returns an upper bound of that, in a fifth of its time: the largest eigenvalue of a matrix P with
// real eigenvalues is at most sqrt(tr P^2).
[[nodiscard]] Vibration vibration_bound(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                        std::span<const PadTangent> tangents);

// Linearises a model near the state of `d`: its pads and its joints' dampers. Springs of joints,
// tendons and actuators are not included. `tangents` and `pads` go in pairs. Throws
// std::invalid_argument if the spans differ in length.
[[nodiscard]] LinearModel linear_model(const mjModel_* m, mjData_* d, std::span<const PadOnBodies> pads,
                                       std::span<const PadTangent> tangents);

// Returns the stepping of the model's integrator.
[[nodiscard]] Stepping stepping_of(const mjModel_* m);

}  // namespace slipbench
