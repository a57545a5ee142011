// The springs of a grasp's fingers.
#pragma once

#include <Eigen/Core>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/stability.h"

namespace slipbench {

// The spring and the dashpot of a grasp's finger. Its carriage, whose motion is given by the arm
// and the drive, pulls it back along x (the closing direction), y and z, and against any rotation.
// As linear springs these hold for small rotations; 100 N m/rad rotate by 0.1 degree under 10 N.
struct FingerSpring {
  Eigen::Vector3d stiffness, damping;         // N/m, N s/m along x, y, z
  double turning_stiffness, turning_damping;  // N m/rad, N m s/rad

  // Returns force and torque on the finger's frame, in the world. `carriage` and `finger`: state of
  // the carriage's and of the finger's frame.
  [[nodiscard]] Vector6d wrench(const BodyState& carriage, const BodyState& finger) const;
  // Returns the force along the closing direction, without the dashpot's [N]: the drive's motor
  // feels it.
  [[nodiscard]] double closing_force(const Pose& carriage, const Pose& finger) const;
  // Returns the tangent about the finger's frame, which is rotated by `rotation`.
  [[nodiscard]] PadTangent tangent(const Eigen::Matrix3d& rotation) const;
};
// `grip`: of the entry `grip`.
FingerSpring finger_spring(const Parameters& grip);

// Vibration of a finger alone on its springs.
Vibration finger_vibration(const Parameters& grip);

}  // namespace slipbench
