// Random pads, surfaces and motions for the property tests. A case is drawn from one stream, so its
// seed identifies it.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>

#include "sim/contact/field.h"
#include "sim/core/random.h"

namespace slipbench::testing_field {

enum class Shape { plane, box, cylinder, sphere, capsule, ellipsoid, grid };
inline constexpr Shape all_shapes[] = {Shape::plane,   Shape::box,       Shape::cylinder, Shape::sphere,
                                       Shape::capsule, Shape::ellipsoid, Shape::grid};

// A surface, and the pose of a pad that faces the middle of its top, with the pad's origin just
// touching.
struct Target {
  Surface surface;
  Pose facing;
};

inline Target target(Shape shape) {
  Target result;
  switch (shape) {
    case Shape::plane: break;
    case Shape::box:  // smaller than the pads, so that some elements hang over its edges
      result.surface = Box{{7e-3, 5e-3, 20e-3}};
      result.facing.position.z() = 20e-3;
      break;
    case Shape::cylinder:  // touched from its side: the pad's +Z is the surface's +X
      result.surface = Cylinder{15e-3, 8e-3};
      result.facing.rotation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
      result.facing.position.x() = 15e-3;
      break;
    case Shape::sphere:
      result.surface = Sphere{15e-3};
      result.facing.position.z() = 15e-3;
      break;
    case Shape::capsule:  // like the cylinder, short enough for the half balls to be touched, too
      result.surface = Capsule{15e-3, 4e-3};
      result.facing.rotation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
      result.facing.position.x() = 15e-3;
      break;
    case Shape::ellipsoid:
      result.surface = Ellipsoid{{20e-3, 15e-3, 12e-3}};
      result.facing.position.z() = 12e-3;
      break;
    case Shape::grid:  // the sphere on a grid
      static const DistanceGrid grid([](const Eigen::Vector3d& p) { return p.norm() - 15e-3; }, Eigen::Vector3d::Constant(-15e-3),
                                     Eigen::Vector3d::Constant(15e-3), 1e-3);
      result.surface = grid;
      result.facing.position.z() = 15e-3;
      break;
  }
  return result;
}

// 1 to `most` elements in units of 1 to 6, within 9 mm of the middle: flat with uneven heights and
// axes, or on a cap of radius 20 mm.
inline PadLayout random_pad(RandomStream& draw, std::size_t most, bool dashpots) {
  PadLayout pad;
  const bool curved = draw.integer(2) == 1, splayed = draw.integer(2) == 1;
  const std::size_t count = 1 + draw.integer(most);
  while (pad.elements.size() < count) {
    UnitRange unit{pad.elements.size(), std::min<std::size_t>(1 + draw.integer(6), count - pad.elements.size())};
    for (std::size_t j = 0; j < unit.count; ++j) {
      Element element;
      const double r = 9e-3 * std::sqrt(draw.uniform()), angle = draw.uniform(0.0, 2.0 * std::numbers::pi);
      element.tip = {r * std::cos(angle), r * std::sin(angle), draw.uniform(0.0, 0.4e-3)};
      if (curved) {
        element.tip.z() = 20e-3 - std::sqrt(20e-3 * 20e-3 - r * r);
        element.axis = ((element.tip - Eigen::Vector3d(0.0, 0.0, 20e-3)) / 20e-3).normalized();
      } else if (splayed) {
        element.axis = Eigen::Vector3d(draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2), -1.0).normalized();
      }
      element.k_normal = std::exp(draw.uniform(std::log(100.0), std::log(1e4)));
      element.k_tangential = element.k_normal * draw.uniform(0.3, 2.0);
      if (dashpots && draw.integer(2) == 1) {
        element.c_normal = element.k_normal * draw.uniform(0.0, 5e-3);
        element.c_tangential = element.k_tangential * draw.uniform(0.0, 5e-3);
      }
      pad.elements.push_back(element);
    }
    pad.units.push_back(unit);
  }
  return pad;
}

inline Friction random_friction(RandomStream& draw) {
  const double mu_static = draw.uniform(0.05, 1.2);
  return {mu_static, mu_static * draw.uniform(0.4, 1.0)};
}

// A smooth random motion of the pad around `facing`: it presses by up to 1.2 mm, lifts by up to 0.4
// mm, slides some mm, turns and rocks.
class RandomMotion {
 public:
  RandomMotion(RandomStream& draw, Pose facing) : facing_(std::move(facing)) {
    for (Wave& wave : waves_) wave = {draw.uniform(2.0, 25.0), draw.uniform(0.0, 2.0 * std::numbers::pi)};
  }

  [[nodiscard]] Pose at(double t) const {
    const auto wave = [&](int k) { return std::sin(waves_[k].rate * t + waves_[k].phase); };
    Pose local;
    local.rotation = (Eigen::AngleAxisd(0.5 * wave(0), Eigen::Vector3d::UnitZ()) *
                      Eigen::AngleAxisd(0.05 * wave(1), Eigen::Vector3d::UnitX()) *
                      Eigen::AngleAxisd(0.05 * wave(2), Eigen::Vector3d::UnitY()))
                         .toRotationMatrix();
    local.position = {2e-3 * wave(3), 2e-3 * wave(4), -0.4e-3 + 0.8e-3 * wave(5)};
    return facing_ * local;
  }

 private:
  struct Wave {
    double rate, phase;  // rad/s, rad
  };
  Pose facing_;
  Wave waves_[6];
};

inline Pose random_pose(RandomStream& draw) {
  Pose pose;
  const Eigen::Vector3d axis = Eigen::Vector3d(draw.normal(), draw.normal(), draw.normal()).normalized();
  pose.rotation = Eigen::AngleAxisd(draw.uniform(0.0, std::numbers::pi), axis).toRotationMatrix();
  pose.position = {draw.uniform(-0.3, 0.3), draw.uniform(-0.3, 0.3), draw.uniform(-0.3, 0.3)};
  return pose;
}

// A pad of one unit with one element whose tip is the origin.
inline PadLayout one_element(double k_n, double k_t, double c_n = 0.0, double c_t = 0.0) {
  PadLayout pad;
  Element element;
  element.k_normal = k_n;
  element.k_tangential = k_t;
  element.c_normal = c_n;
  element.c_tangential = c_t;
  pad.elements = {element};
  pad.units = {{0, 1}};
  return pad;
}

inline Pose at(double x, double y, double z) {
  Pose pose;
  pose.position = {x, y, z};
  return pose;
}

}  // namespace slipbench::testing_field
