// Rotations by angles. Eigen's own (AngleAxis, slerp) call the C library's functions, whose
// rounding depends on the processor.
#pragma once

#include <Eigen/Core>

namespace slipbench {

// The rotation by `angle` [rad] about `axis`, of length 1 (Rodrigues' formula).
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& axis, double angle);

// The rotation Rz Ry Rx: turns by `angles` [rad] about the fixed X, Y and Z axes, in this order.
Eigen::Matrix3d rotation_by_axes(const Eigen::Vector3d& angles);

// Axis times angle [rad] of a rotation; the angle is in [0, pi].
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

// Interpolates from `start` (share 0) to `end` (share 1), about one axis at a constant rate.
Eigen::Matrix3d interpolated_rotation(const Eigen::Matrix3d& start, const Eigen::Matrix3d& end, double share);

}  // namespace slipbench
