#include "sim/mujoco/linear/dense.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace slipbench {

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
