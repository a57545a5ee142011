// The spring and the dashpot of a grasp's finger: its carriage, which moves as the arm and the drive say, pulls it back along x (the
// closing direction), y and z, and against any turn. As linear springs these hold for small turns; 100 N m/rad turn by 0.1 degree under
// 10 N.
#pragma once

#include <Eigen/Core>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/mujoco/linear/stability.h"

namespace slipbench {

struct FingerSpring {
  Eigen::Vector3d stiffness, damping;         // N/m, N s/m along x, y, z
  double turning_stiffness, turning_damping;  // N m/rad, N m s/rad

  // Force and torque on the finger's frame, in the world. `carriage` and `finger`: state of the carriage's and of the finger's frame.
  [[nodiscard]] Vector6d wrench(const BodyState& carriage, const BodyState& finger) const;
  // The force along the closing direction, without that of the dashpot [N]: what the drive's motor feels.
  [[nodiscard]] double closing_force(const Pose& carriage, const Pose& finger) const;
  // About the finger's frame, which is turned as `rotation`.
  [[nodiscard]] PadTangent tangent(const Eigen::Matrix3d& rotation) const;
};
// `grip`: of the entry `grip`.
FingerSpring finger_spring(const Parameters& grip);

// A finger alone on its springs.
Vibration finger_vibration(const Parameters& grip);

}  // namespace slipbench
