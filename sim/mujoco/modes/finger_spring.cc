#include "sim/mujoco/modes/finger_spring.h"

#include <algorithm>
#include <cmath>

namespace slipbench {

Vector6d FingerSpring::wrench(const BodyState& carriage, const BodyState& finger) const {
  const Eigen::Matrix3d back = carriage.pose.rotation.transpose();
  const Eigen::Vector3d offset = finger.pose.position - carriage.pose.position;
  // Motion due to the carriage's rotation is not stretch.
  const Eigen::Vector3d speed = finger.velocity - carriage.velocity - carriage.angular_velocity.cross(offset);
  const Eigen::Vector3d pull = stiffness.cwiseProduct(back * offset) + damping.cwiseProduct(back * speed);
  // The rotation vector of a small rotation R is the antisymmetric part of R, to third order.
  const Eigen::Matrix3d turn = finger.pose.rotation * back;
  const Eigen::Vector3d turned = 0.5 * Eigen::Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
  Vector6d result;
  result << -(carriage.pose.rotation * pull),
      -turning_stiffness * turned - turning_damping * (finger.angular_velocity - carriage.angular_velocity);
  return result;
}

double FingerSpring::closing_force(const Pose& carriage, const Pose& finger) const {
  return stiffness.x() * carriage.rotation.col(0).dot(carriage.position - finger.position);
}

PadTangent FingerSpring::tangent(const Eigen::Matrix3d& rotation) const {
  const auto turned = [&rotation](const Eigen::Vector3d& along, double about) {
    Matrix6d result = Matrix6d::Zero();
    result.topLeftCorner<3, 3>() = rotation * along.asDiagonal() * rotation.transpose();
    result.bottomRightCorner<3, 3>() = about * Eigen::Matrix3d::Identity();
    return result;
  };
  return {turned(stiffness, turning_stiffness), turned(damping, turning_damping)};
}

FingerSpring finger_spring(const Parameters& grip) {
  const double ratio = 2.0 * grip.number("damping_ratio"), mass = grip.number("finger_mass");
  const double turning = grip.number("turning_stiffness"), inertia = grip.number("finger_inertia");
  const Eigen::Vector3d stiffness = Eigen::Vector3d::Map(grip.vector("stiffness").data());
  return {stiffness, ratio * (mass * stiffness).cwiseSqrt(), turning, ratio * std::sqrt(turning * inertia)};
}

Vibration finger_vibration(const Parameters& grip) {
  const double along = finger_spring(grip).stiffness.maxCoeff() / grip.number("finger_mass");
  const double about = grip.number("turning_stiffness") / grip.number("finger_inertia");
  const double omega = std::sqrt(std::max(along, about));
  return {omega, 2.0 * grip.number("damping_ratio") * omega};
}

}  // namespace slipbench
