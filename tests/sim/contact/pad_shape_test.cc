// Pads of many elements: flat, curved, at the edge of a box; and the shapes' distances against
// sampling.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::pad_shape_test {
namespace {

// `count` elements of equal area on the cap of height `cap` of a sphere of radius `radius`
// (Fibonacci lattice: equal steps in height, which by Archimedes are equal areas), each with
// `stiffness` [N/m^3] times its area.
PadLayout cap(std::size_t count, double radius, double cap, double stiffness) {
  PadLayout pad;
  const double area = 2.0 * std::numbers::pi * radius * cap / static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double h = cap * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double r = std::sqrt(h * (2.0 * radius - h));
    const double angle = static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    Element element;
    element.tip = {r * std::cos(angle), r * std::sin(angle), h};
    element.axis = ((element.tip - Eigen::Vector3d(0.0, 0.0, radius)) / radius).normalized();
    element.k_normal = stiffness * area;
    element.k_tangential = 0.5 * stiffness * area;
    pad.units.push_back({pad.elements.size(), 1});
    pad.elements.push_back(element);
  }
  return pad;
}

TEST(PadShape, FlatGridOf256CarriesAreaTimesDepth) {
  Field field(oracle::square_grid(16, 15e-3, 40.0, 20.0), Plane{}, {0.5, 0.5});
  field.step(at(1e-3, 2e-3, -0.3e-3), 1e-3);
  EXPECT_NEAR(field.wrench_on_pad().force.z(), 256 * 40.0 * 0.3e-3, 1e-12);
  EXPECT_NEAR(field.wrench_on_pad().torque.norm(), 0.0, 1e-12);  // symmetric about the pad's origin
}

TEST(PadShape, CurvedPadOnAPlaneCarriesTheIntegralOverTheCap) {
  // Force = stiffness x integral over 0 < h < d of (d - h) 2 pi R dh = stiffness x pi R d^2. The
  // lattice is the midpoint rule in h with the step e = cap/count: exact except for the step with
  // the kink at d, whose error is at most e^2/8. So the error is at most stiffness x 2 pi R e^2/8.
  const double radius = 20e-3, height = 1e-3, stiffness = 1e8;
  for (const std::size_t count : {256U, 4096U}) {
    const double step = height / static_cast<double>(count);
    for (const double depth : {0.05e-3, 0.3e-3, 0.77e-3}) {
      Field field(cap(count, radius, height, stiffness), Plane{}, {0.5, 0.5});
      field.step(at(0.0, 0.0, -depth), 1e-3);
      const double exact = stiffness * std::numbers::pi * radius * depth * depth;
      const double bound = stiffness * 2.0 * std::numbers::pi * radius * step * step / 8.0;
      EXPECT_NEAR(field.wrench_on_pad().force.z(), exact, bound + 1e-12 * exact) << count << " elements, depth " << depth;
    }
  }
}

TEST(PadShape, ElementsBesideABoxDoNotTouch) {
  // A pad of 20 mm on a box of 10 x 8 mm: only elements over the top touch, on the top, by their
  // full depth. Pitch 20/16 = 1.25 mm, so no element lies on an edge.
  const Box box{{5e-3, 4e-3, 20e-3}};
  const double depth = 0.4e-3;
  const PadLayout pad = oracle::square_grid(16, 20e-3, 40.0, 20.0);
  struct Place {
    double x, y;
  };
  for (const auto& [x, y] : {Place{0.0, 0.0}, Place{0.0, 4.3e-3}, Place{5.2e-3, 0.0}, Place{13e-3, 12e-3}, Place{16e-3, 15e-3}}) {
    Field field(pad, box, {0.5, 0.5});
    field.step(at(x, y, 20e-3 - depth), 1e-3);
    std::size_t over = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      const Eigen::Vector3d tip = pad.elements[i].tip + Eigen::Vector3d(x, y, 0.0);
      const bool inside = std::abs(tip.x()) < 5e-3 && std::abs(tip.y()) < 4e-3;
      over += inside;
      ASSERT_EQ(field.state(i), inside ? ElementState::stick : ElementState::detached)
          << "element " << i << " at " << tip.transpose();
      if (inside) {
        ASSERT_EQ(field.normal(i), Eigen::Vector3d(0.0, 0.0, 1.0));
      }
    }
    EXPECT_NEAR(field.wrench_on_surface().force.z(), -40.0 * depth * static_cast<double>(over), 1e-12);
    if (x > 15e-3) {
      EXPECT_EQ(over, 0U);  // the whole pad is beyond the corner
    }
  }
}

TEST(PadShape, HalfAPadOverAnEdgeCarriesHalf) {
  const PadLayout pad = oracle::square_grid(16, 20e-3, 40.0, 20.0);
  Field field(pad, Box{{30e-3, 30e-3, 20e-3}}, {0.5, 0.5});
  field.step(at(30e-3, 0.0, 20e-3 - 0.4e-3), 1e-3);
  const Wrench wrench = field.wrench_on_pad();
  EXPECT_NEAR(wrench.force.z(), 128 * 40.0 * 0.4e-3, 1e-12);
  // Columns at -0.625, -1.875, ... -9.375 mm: mean lever -5 mm, so the force F at x = -5 mm gives
  // +5 mm F about Y.
  EXPECT_NEAR(wrench.torque.y(), 5e-3 * wrench.force.z(), 1e-14);
}

TEST(PadShape, PadTiltedOverAnEdgePressesOnTheTopOnly) {
  // Tilted by 1 degree over either edge of the box. A tip enters through the side only when it is
  // within depth x tan(1 deg) < 15 um of it.
  const PadLayout pad = oracle::square_grid(16, 20e-3, 40.0, 20.0);
  for (const double tilt : {std::numbers::pi / 180.0, -std::numbers::pi / 180.0}) {
    for (const double x : {-10e-3, 10e-3}) {
      Field field(pad, Box{{10e-3, 10e-3, 20e-3}}, {0.5, 0.5});
      Pose pose = at(x, 0.0, 20e-3 - 0.4e-3);
      pose.rotation = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
      field.step(pose, 1e-3);
      double expected = 0.0;
      for (std::size_t i = 0; i < field.size(); ++i) {
        const Eigen::Vector3d tip = pose * pad.elements[i].tip;
        const bool inside = std::abs(tip.x()) < 10e-3 && std::abs(tip.y()) < 10e-3 && tip.z() < 20e-3;
        if (inside) expected += 40.0 * (20e-3 - tip.z());
        if (field.state(i) != ElementState::detached) {
          ASSERT_EQ(field.normal(i), Eigen::Vector3d(0.0, 0.0, 1.0)) << "element " << i;
        }
      }
      EXPECT_GT(expected, 0.5);
      EXPECT_NEAR(field.wrench_on_surface().force.z(), -expected, 1e-12);
      EXPECT_EQ(field.wrench_on_surface().force.x(), 0.0);
    }
  }
}

// Points on the surface of a box or cylinder, at most `grid`/sqrt(2) from a neighbour on the same
// face.
std::vector<Eigen::Vector3d> sampled(const Box& box, double grid) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const int na = static_cast<int>(std::ceil(2.0 * box.half[a] / grid)),
              nb = static_cast<int>(std::ceil(2.0 * box.half[b] / grid));
    for (int i = 0; i <= na; ++i) {
      for (int j = 0; j <= nb; ++j) {
        for (const double side : {-1.0, 1.0}) {
          Eigen::Vector3d p;
          p[k] = side * box.half[k];
          p[a] = box.half[a] * (2.0 * i / na - 1.0);
          p[b] = box.half[b] * (2.0 * j / nb - 1.0);
          points.push_back(p);
        }
      }
    }
  }
  return points;
}

std::vector<Eigen::Vector3d> sampled(const Cylinder& c, double grid) {
  std::vector<Eigen::Vector3d> points;
  const int around = static_cast<int>(std::ceil(2.0 * std::numbers::pi * c.radius / grid));
  const int along = static_cast<int>(std::ceil(2.0 * c.half_length / grid)), out = static_cast<int>(std::ceil(c.radius / grid));
  for (int i = 0; i < around; ++i) {
    const double x = std::cos(2.0 * std::numbers::pi * i / around), y = std::sin(2.0 * std::numbers::pi * i / around);
    for (int j = 0; j <= along; ++j) points.emplace_back(c.radius * x, c.radius * y, c.half_length * (2.0 * j / along - 1.0));
    for (int j = 0; j < out; ++j) {
      for (const double side : {-1.0, 1.0})
        points.emplace_back(c.radius * j / out * x, c.radius * j / out * y, side * c.half_length);
    }
  }
  return points;
}

template <class Shape, class Outside>
void check_outside(const Shape& shape, const Eigen::Vector3d& size, std::uint64_t seed, const Outside& outside) {
  const double grid = 0.2e-3, farthest = grid / std::numbers::sqrt2;  // of a point of the surface from its nearest sample
  const std::vector<Eigen::Vector3d> points = sampled(shape, grid);
  const auto distance = [&](const Eigen::Vector3d& p) {
    double nearest = 1.0;
    for (const Eigen::Vector3d& point : points) nearest = std::min(nearest, (point - p).squaredNorm());
    return std::sqrt(nearest);
  };
  RandomStream draw(seed, 0, "surface sampling");
  int looked_at = 0;
  while (looked_at < 100) {
    const Eigen::Vector3d p(size.x() * draw.uniform(-1.6, 1.6), size.y() * draw.uniform(-1.6, 1.6),
                            size.z() * draw.uniform(-1.6, 1.6));
    if (!outside(p)) continue;
    ++looked_at;
    const Eigen::Vector3d axis = Eigen::Vector3d(draw.normal(), draw.normal(), draw.normal()).normalized();
    const SurfacePoint met = shape.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z());
    const Eigen::Vector3d n(met.nx, met.ny, met.nz);
    ASSERT_NEAR(n.norm(), 1.0, 1e-12);
    // The nearest sample is no nearer than the surface, and at most `farthest` further away.
    const double nearest = distance(p);
    ASSERT_LE(met.gap, nearest + 1e-12) << p.transpose();
    ASSERT_GE(met.gap, nearest - farthest) << p.transpose();
    ASSERT_LE(distance(p - met.gap * n), farthest) << "the foot of " << p.transpose() << " lies on the surface";
  }
}

TEST(SurfaceShape, DistanceOutsideABoxIsThatOfItsNearestPoint) {
  const Eigen::Vector3d half(3e-3, 4e-3, 5e-3);
  check_outside(Box{half}, half, 1, [&](const Eigen::Vector3d& p) { return (p.array().abs() > half.array()).any(); });
}

TEST(SurfaceShape, DistanceOutsideACylinderIsThatOfItsNearestPoint) {
  check_outside(Cylinder{4e-3, 5e-3}, {4e-3, 4e-3, 5e-3}, 2,
                [](const Eigen::Vector3d& p) { return p.head<2>().norm() > 4e-3 || std::abs(p.z()) > 5e-3; });
}

TEST(SurfaceShape, InsideABoxTheFaceIsTheOneThroughWhichTheTipCame) {
  // Backwards along the axis, the first coordinate that leaves the box determines the face. A tip
  // that would leave the box sooner by going forward points out of it and touches nothing.
  const Box box{{3e-3, 4e-3, 5e-3}};
  RandomStream draw(3, 0, "box faces");
  int inwards = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d p(draw.uniform(-3e-3, 3e-3), draw.uniform(-4e-3, 4e-3), draw.uniform(-5e-3, 5e-3));
    const Eigen::Vector3d axis = Eigen::Vector3d(draw.normal(), draw.normal(), draw.normal()).normalized();
    std::size_t face = 0;
    double back = 1.0, ahead = 1.0;
    for (int c = 0; c < 3; ++c) {
      const double to_plus = (box.half[c] - p[c]) / std::abs(axis[c]), to_minus = (box.half[c] + p[c]) / std::abs(axis[c]);
      const double way = axis[c] > 0.0 ? to_minus : to_plus;
      ahead = std::min(ahead, axis[c] > 0.0 ? to_plus : to_minus);
      if (way < back) {
        back = way;
        face = static_cast<std::size_t>(c);
      }
    }
    const SurfacePoint met = box.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z());
    if (back > ahead) {
      EXPECT_GT(met.gap, 0.0) << p.transpose() << " looking along " << axis.transpose();
      continue;
    }
    ++inwards;
    const auto c = static_cast<Eigen::Index>(face);
    const double side = axis[c] > 0.0 ? -1.0 : 1.0;
    EXPECT_EQ((std::vector{met.nx, met.ny, met.nz})[face], side);
    EXPECT_NEAR(met.gap, side * p[c] - box.half[c], 1e-18);
    EXPECT_LT(met.nx * axis.x() + met.ny * axis.y() + met.nz * axis.z(), 0.0);
  }
  EXPECT_GT(inwards, 500);
}

TEST(SurfaceShape, InsideACylinderNearItsEdgeTheFaceIsTheOneThroughWhichTheTipCame) {
  // Tips up to 0.2 mm below side and cap. The element's axis lies in a plane with the cylinder's
  // axis, where side and cap are straight lines.
  const Cylinder cylinder{15e-3, 8e-3};
  RandomStream draw(4, 0, "cylinder faces");
  int sides = 0, caps = 0;
  for (int k = 0; k < 2000; ++k) {
    const double depth = draw.uniform(1e-6, 0.2e-3), below = draw.uniform(1e-6, 0.2e-3), angle = draw.uniform(0.0, 6.28);
    const double lean = draw.uniform(0.0, 0.5 * std::numbers::pi), r = cylinder.radius - depth;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    const Eigen::Vector3d p = r * out + Eigen::Vector3d(0.0, 0.0, cylinder.half_length - below);
    const Eigen::Vector3d axis = -std::cos(lean) * out - Eigen::Vector3d(0.0, 0.0, std::sin(lean));
    const double to_side = depth / std::cos(lean), to_cap = below / std::sin(lean);
    const SurfacePoint met = cylinder.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z());
    if (to_side < to_cap) {
      ++sides;
      EXPECT_EQ(met.nz, 0.0);
      EXPECT_NEAR(met.gap, -depth, 1e-15);
    } else {
      ++caps;
      EXPECT_EQ(met.nz, 1.0);
      EXPECT_NEAR(met.gap, -below, 1e-15);
    }
  }
  EXPECT_GT(sides, 500);
  EXPECT_GT(caps, 500);
}

TEST(SurfaceShape, SphereDistanceIsRadial) {
  const Sphere sphere{15e-3};
  RandomStream draw(6, 0, "sphere");
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d out = Eigen::Vector3d(draw.normal(), draw.normal(), draw.normal()).normalized();
    const double r = draw.uniform(10e-3, 20e-3);
    const Eigen::Vector3d p = r * out, axis = -out;
    const SurfacePoint met = sphere.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z());
    EXPECT_NEAR(met.gap, r - 15e-3, 1e-16);
    EXPECT_NEAR((Eigen::Vector3d(met.nx, met.ny, met.nz) - out).norm(), 0.0, 1e-14);
  }
}

}  // namespace
}  // namespace slipbench::testing_field::pad_shape_test
