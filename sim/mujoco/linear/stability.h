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
// robot's size. The limits of a step stand below.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sim/core/pad_layout.h"
#include "sim/core/pose.h"
#include "sim/field/field.h"

struct mjData_;
struct mjModel_;

namespace slipbench {

// The longest steps of a linear model: stable, and right. It knows no MuJoCo, so it is compiled once for all versions.
//
// Where an explicit step diverges. With the pads' stiffness K and damping C (their dashpots, of whatever pad) and the dampers D of the model's
// joints
//   M q'' = -K q - (C + D) q'.
// MuJoCo's one-stage integrators take the velocity first and the position with the new one, and dampers of joints implicitly (but Euler
// where the model disables that with `eulerdamp`: then they are as explicit as C, and count there):
//   (M + h D) (v' - v) = -h (K x + C v + D v),  x' = x + h v'
// A mode that grows by l a step has v = (l - 1)/(h l) x, and with m, k, c, d the squares of M, K, C, D in its shape x
//   (m + h d) (l - 1)^2 + h (c + d) (l - 1) + h^2 k l = 0
// With real m, k, c, d, as symmetric matrices give also for a complex x, Jury's conditions say that |l| <= 1 as long as
// h^2 k + 2 h c <= 4 m + 2 h d (then h (c + d) <= 2 (m + h d) as well), and at equality l = -1 is a root. So with any number of modes, damped
// alike or not, the limit is the least h with
//   largest eigenvalue of (M + h D/2)^-1 (h^2 K + 2 h C) = 4
// of one mode with a viscous time tau (c = tau k) h omega = sqrt(4 + (tau omega)^2) - tau omega, 2 without damping. With RK4 all is
// explicit: with l the roots of l^2 M + l (C + D) + K, the limit is the least h with |R(h l)| = 1 for one of them, R(z) = 1 + z + z^2/2
// + z^3/6 + z^4/24: h omega = sqrt(8) without damping, h |l| = 2.785 where it is strong.
//
// Stable is not yet accurate: near the limit a slide comes out wrong (shared MUJOCO.md, section B). Right to 0.05 % is a step
// with
//   h omega <= 0.75  and  h tau omega^2 <= 1, the second so that damping never turns a velocity round within one step.

// Factors of dense matrices. They know no MuJoCo, so they are compiled once for all versions: each of Eigen's factorisations takes seconds.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// The matrix of r x.
[[nodiscard]] inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d cross;
  cross << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return cross;
}

// A symmetric matrix as a sum of squares: K = sum_k scale_k values_k values_k'. Terms of nothing but rounding have the scale 0.
struct Squares {
  std::array<double, 6> scale;
  Matrix6d values;  // columns
};
[[nodiscard]] Squares squares(const Matrix6d& k);

// R of K = R'R, for K positive semi-definite up to rounding.
[[nodiscard]] Matrix6d root(const Matrix6d& k);

// x of A x = b. [n, n], [n]; A is regular.
[[nodiscard]] Eigen::VectorXd solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

// The fastest mode of a model.
struct Vibration {
  double omega = 0.0;         // rad/s, natural frequency; 0: nothing vibrates
  double damping_rate = 0.0;  // 1/s, largest eigenvalue of M^-1 C; tau omega^2 for a viscous time tau
};

// The longest step [s] at which an explicit force is right (see above): min(0.75/omega, 1/damping_rate); infinite when nothing
// vibrates.
[[nodiscard]] double longest_explicit_step(const Vibration& vibration);

// A model near a state. [nv, nv]
struct LinearModel {
  Eigen::MatrixXd mass;
  Eigen::MatrixXd stiffness;      // K
  Eigen::MatrixXd damping;        // C, and joints' dampers that the integrator takes explicitly
  Eigen::MatrixXd joint_damping;  // D
};

// How an integrator steps: the velocity first and the position with the new one, or RK4.
enum class Stepping { velocity_first, runge_kutta };

// The step [s] beyond which the model diverges under explicit pads (see above), less 1 %: the tangents leave out that loads turn with the
// surface, which makes 0.3 % where soft pads are pressed in by a fifth of their pitch (tools/program/cost/stability_map.h). Infinite when nothing
// vibrates.
[[nodiscard]] double divergence_step(const LinearModel& model, Stepping stepping);

// Largest eigenvalue of a symmetric matrix.
[[nodiscard]] double largest_eigenvalue(const Eigen::MatrixXd& a);

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

// Pads, and the tangent of each.
struct PadTangents {
  std::vector<PadOnBodies> bodies;
  std::vector<PadTangent> tangents;
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
