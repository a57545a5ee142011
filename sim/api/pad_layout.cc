#include "sim/api/pad_layout.h"

#include <cmath>

#include <Eigen/Geometry>

namespace slipbench {

// Eigen's FromTwoVectors decomposes a matrix for half a turn, which takes 10 s to compile.
Eigen::Matrix3d element_frame(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d z = -axis.normalized();
  // 1 + z, without the cancellation near half a turn.
  const double rest = z.z() < -0.999 ? z.head<2>().squaredNorm() / (1.0 - z.z()) : 1.0 + z.z();
  if (rest == 0.0) return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  const double s = std::sqrt(2.0 * rest), share = 1.0 / s;
  return Eigen::Quaterniond(0.5 * s, -z.y() * share, z.x() * share, 0.0).toRotationMatrix();
}

}  // namespace slipbench
