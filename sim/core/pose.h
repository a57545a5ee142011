// Poses and velocities of bodies, and forces on them.
#pragma once

#include <Eigen/Geometry>

namespace slipbench {

// Pose of frame B in frame A: p_A = rotation * p_B + position.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + position; }
  [[nodiscard]] Pose operator*(const Pose& other) const { return {rotation * other.rotation, *this * other.position}; }
  [[nodiscard]] Pose inverse() const { return {rotation.transpose(), -(rotation.transpose() * position)}; }
};

// Velocity of frame B relative to frame A, in A.
struct Twist {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   // m/s, of B's origin
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  // rad/s
};

// Force and torque on a body.
struct Wrench {
  Eigen::Vector3d force;   // N
  Eigen::Vector3d torque;  // N m
};

// A body at one instant, in the world frame.
struct BodyState {
  Pose pose;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // m/s, of the body frame's origin
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // rad/s
};

}  // namespace slipbench
