#include "sim/contact/surface/thickness.h"

#include <algorithm>
#include <limits>
#include <variant>

namespace slipbench {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

struct HalfThickness {
  double operator()(const Plane& /*shape*/) const { return infinite; }
  double operator()(const Box& box) const { return box.half.minCoeff(); }
  double operator()(const Cylinder& cylinder) const { return std::min(cylinder.radius, cylinder.half_length); }
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Capsule& capsule) const { return capsule.radius; }
  double operator()(const Ellipsoid& ellipsoid) const { return ellipsoid.half.minCoeff(); }
  double operator()(const DistanceGrid& /*shape*/) const { return infinite; }
};

struct BallAround {
  double operator()(const Plane& /*shape*/) const { return infinite; }
  double operator()(const Box& box) const { return box.half.norm(); }
  double operator()(const Cylinder& cylinder) const { return Eigen::Vector2d(cylinder.radius, cylinder.half_length).norm(); }
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Capsule& capsule) const { return capsule.radius + capsule.half_length; }
  double operator()(const Ellipsoid& ellipsoid) const { return ellipsoid.half.maxCoeff(); }
  double operator()(const DistanceGrid& /*shape*/) const { return infinite; }
};

}  // namespace

double thickness_of(const Surface& surface) { return 2.0 * std::visit(HalfThickness{}, surface); }

double ball_around(const Surface& surface) { return std::visit(BallAround{}, surface); }

}  // namespace slipbench
