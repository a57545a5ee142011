// Factors of dense matrices. They know no MuJoCo, so they are compiled once for all versions: each of Eigen's factorisations takes seconds.
#pragma once

#include <array>

#include <Eigen/Core>

namespace slipbench {

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

}  // namespace slipbench
