#include "sim/core/math/rotation.h"

#include <Eigen/Geometry>

#include "sim/core/math.h"

namespace slipbench {

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle) {
  const auto [sine, cosine] = math::sincos(angle);
  const Eigen::Vector3d s = sine * axis, c = (1.0 - cosine) * axis;
  Eigen::Matrix3d rotation;
  rotation << c.x() * axis.x() + cosine, c.x() * axis.y() - s.z(), c.x() * axis.z() + s.y(),  //
      c.x() * axis.y() + s.z(), c.y() * axis.y() + cosine, c.y() * axis.z() - s.x(),          //
      c.x() * axis.z() - s.y(), c.y() * axis.z() + s.x(), c.z() * axis.z() + cosine;
  return rotation;
}

Eigen::Matrix3d rotation_by_axes(const Eigen::Vector3d& angles) {
  return rotation_about(Eigen::Vector3d::UnitZ(), angles.z()) * rotation_about(Eigen::Vector3d::UnitY(), angles.y()) *
         rotation_about(Eigen::Vector3d::UnitX(), angles.x());
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond turn(rotation);
  const double sine = turn.vec().norm();  // of half the angle
  if (sine == 0.0) return Eigen::Vector3d::Zero();
  const double half = turn.w() < 0.0 ? -math::atan2(sine, -turn.w()) : math::atan2(sine, turn.w());
  return 2.0 * half / sine * turn.vec();
}

Eigen::Matrix3d interpolated_rotation(const Eigen::Matrix3d& start, const Eigen::Matrix3d& end, double share) {
  const Eigen::Vector3d turn = rotation_vector(start.transpose() * end);
  const double angle = turn.norm();
  if (angle == 0.0) return start;
  return start * rotation_about(turn / angle, share * angle);
}

}  // namespace slipbench
