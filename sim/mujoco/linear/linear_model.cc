#include "sim/mujoco/linear/linear_model.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace slipbench {
namespace {

constexpr double accurate_phase = 0.75;   // h omega
constexpr double accurate_damping = 1.0;  // h tau omega^2
constexpr double linearised = 0.99;       // share of the limit from tangents

// Largest eigenvalue of B^-1 A, symmetric matrices, B positive definite.
double largest_ratio(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(a, b, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff();
}

// Bisects for the largest step at which `inside` is true: it must be true up to a step and false
// beyond it. `within`: a step at which it is true.
template <class Predicate>
double last_inside(double within, Predicate&& inside) {
  double low = within, high = 2.0 * within;
  while (inside(high)) low = std::exchange(high, 2.0 * high);
  while (high - low > 1e-12 * high) {
    const double middle = 0.5 * (low + high);
    (inside(middle) ? low : high) = middle;
  }
  return low;
}

double velocity_first_limit(const LinearModel& model) {
  const double omega = std::sqrt(std::max(0.0, largest_ratio(model.stiffness, model.mass)));
  const double rate = largest_ratio(model.damping, model.mass);
  if (!(omega > 0.0) && !(rate > 0.0)) return std::numeric_limits<double>::infinity();
  // (h omega)^2 <= 1 and 2 h rate <= 1 add up to at most 2, and dampers of joints only help.
  const double stable = 1.0 / std::max(omega, 2.0 * rate);
  return last_inside(stable, [&](double h) {
    return largest_ratio(h * h * model.stiffness + 2.0 * h * model.damping, model.mass + 0.5 * h * model.joint_damping) <= 4.0;
  });
}

// Returns the least size of h lambda, along the ray of lambda, at which |R| = 1.
double runge_kutta_reach(std::complex<double> direction) {
  const auto stable = [&](double size) {
    const std::complex<double> z = size * direction;
    // Without damping |R| stays within rounding of 1 for small z.
    return std::norm(1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))) <= 1.0 + 1e-9;
  };
  // The region of stability ends before |z| = 3 on the left of the imaginary axis, and no ray
  // enters it twice there.
  double size = 1.0;
  while (stable(size + 0.01)) size += 0.01;
  double beyond = size + 0.01;
  while (beyond - size > 1e-12) {
    const double middle = 0.5 * (size + beyond);
    (stable(middle) ? size : beyond) = middle;
  }
  return size;
}

double runge_kutta_limit(const LinearModel& model) {
  const Eigen::Index n = model.mass.rows();
  const Eigen::LLT<Eigen::MatrixXd> mass(model.mass);
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  slope.topRightCorner(n, n).setIdentity();
  slope.bottomLeftCorner(n, n) = -mass.solve(model.stiffness);
  slope.bottomRightCorner(n, n) = -mass.solve(model.damping + model.joint_damping);
  // Scale coordinates to the fastest mode's velocity: otherwise one half of the matrix would be
  // below the other's rounding error.
  const double scale = std::sqrt(slope.norm());
  if (!(scale > 0.0)) return std::numeric_limits<double>::infinity();
  slope.topRightCorner(n, n) *= scale;
  slope.bottomLeftCorner(n, n) /= scale;
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(slope, false);
  const double fastest = std::sqrt(solver.eigenvalues().cwiseAbs2().maxCoeff());
  double limit = std::numeric_limits<double>::infinity();
  for (const std::complex<double>& rate : solver.eigenvalues()) {
    const double size = std::sqrt(std::norm(rate));
    if (size < 0.5 * fastest) continue;  // reaches differ by less than that: from 2.6 to 3
    limit = std::min(limit, runge_kutta_reach(rate / size) / size);
  }
  return limit;
}

}  // namespace

double largest_eigenvalue(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().maxCoeff();
}

double longest_explicit_step(const Vibration& vibration) {
  const double infinite = std::numeric_limits<double>::infinity();
  const double phase = vibration.omega > 0.0 ? accurate_phase / vibration.omega : infinite;
  const double damping = vibration.damping_rate > 0.0 ? accurate_damping / vibration.damping_rate : infinite;
  return std::min(phase, damping);
}

double divergence_step(const LinearModel& model, Stepping stepping) {
  return linearised * (stepping == Stepping::runge_kutta ? runge_kutta_limit(model) : velocity_first_limit(model));
}

Squares squares(const Matrix6d& k) {
  const Eigen::LDLT<Matrix6d> factor(k);
  Squares out;
  out.values = factor.transpositionsP().transpose() * Matrix6d(factor.matrixL());
  for (int i = 0; i < 6; ++i) out.scale[static_cast<std::size_t>(i)] = std::max(0.0, factor.vectorD()[i]);
  return out;
}

Matrix6d root(const Matrix6d& k) {
  const Squares terms = squares(k);
  return Eigen::Map<const Eigen::Array<double, 6, 1>>(terms.scale.data()).sqrt().matrix().asDiagonal() * terms.values.transpose();
}

Eigen::VectorXd solution(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) { return a.partialPivLu().solve(b); }

}  // namespace slipbench
