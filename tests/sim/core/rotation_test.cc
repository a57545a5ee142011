#include "sim/core/math/rotation.h"

#include <gtest/gtest.h>

#include <numbers>

#include <Eigen/Geometry>

#include "sim/core/random.h"

namespace slipbench {
namespace {

constexpr double rounding = 1e-14;

Eigen::Vector3d drawn(RandomStream& stream) {
  return {stream.uniform(-1.0, 1.0), stream.uniform(-1.0, 1.0), stream.uniform(-1.0, 1.0)};
}

TEST(Rotation, EqualsTheQuaternionsOfEigen) {
  RandomStream stream(1, 0, "rotations");
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d axis = drawn(stream).normalized(), angles = 3.0 * drawn(stream);
    const double angle = stream.uniform(-3.0, 3.0), share = stream.uniform();
    const Eigen::Matrix3d turn = rotation_about(axis, angle), by_axes = rotation_by_axes(angles);
    EXPECT_TRUE(turn.isApprox(Eigen::AngleAxisd(angle, axis).toRotationMatrix(), rounding));
    const Eigen::Quaterniond all = Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX());
    EXPECT_TRUE(by_axes.isApprox(all.toRotationMatrix(), rounding));
    EXPECT_TRUE(rotation_vector(turn).isApprox(angle * axis, 1e-12));
    const Eigen::Quaterniond start(by_axes), end(Eigen::Matrix3d(by_axes * turn));
    EXPECT_TRUE(
        interpolated_rotation(by_axes, by_axes * turn, share).isApprox(start.slerp(share, end).toRotationMatrix(), 1e-12));
  }
}

TEST(Rotation, NoAngleIsExact) {
  EXPECT_EQ(rotation_about(Eigen::Vector3d::UnitY(), 0.0), Eigen::Matrix3d::Identity());
  EXPECT_EQ(rotation_vector(Eigen::Matrix3d::Identity()), Eigen::Vector3d::Zero());
  const Eigen::Matrix3d turn = rotation_about(Eigen::Vector3d::UnitX(), 0.3);
  EXPECT_EQ(interpolated_rotation(turn, turn, 0.5), turn);
}

TEST(Rotation, HalfATurnKeepsItsAngle) {
  EXPECT_NEAR(rotation_vector(rotation_about(Eigen::Vector3d::UnitZ(), std::numbers::pi)).norm(), std::numbers::pi, rounding);
}

}  // namespace
}  // namespace slipbench
