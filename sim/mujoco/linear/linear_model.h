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
// A stable step need not be accurate: near the limit a slide is wrong by several percent (measured).
// A step is accurate to 0.05 % with
//   h omega <= 0.75  and  h tau omega^2 <= 1,
// the second so that damping never reverses a velocity within one step.
#pragma once

#include <array>

#include <Eigen/Core>

namespace slipbench {

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

}  // namespace slipbench
