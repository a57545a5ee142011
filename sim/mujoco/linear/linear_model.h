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
#pragma once

#include <Eigen/Core>

namespace slipbench {

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

}  // namespace slipbench
