// Capsule, ellipsoid, distance grid and mesh: values by hand, points whose nearest point is known
// by construction, and convergence orders.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/contact/surface/mesh_distance.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/error.h"
#include "sim/core/random.h"
#include "tests/expect.h"
#include "tests/oracle/meshes.h"

namespace slipbench {
namespace {

using Vector = Eigen::Vector3d;

template <class Shape>
SurfacePoint met(const Shape& shape, const Vector& p, const Vector& axis) {
  return shape.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z());
}

Vector normal(const SurfacePoint& point) { return {point.nx, point.ny, point.nz}; }

// In braces, since compilers evaluate the arguments in parentheses in different orders.
Vector random_direction(RandomStream& draw) { return Vector{draw.normal(), draw.normal(), draw.normal()}.normalized(); }

template <class Shape>
void expect_met(const Shape& shape, const Vector& p, const Vector& axis, double gap, const Vector& n) {
  const SurfacePoint point = met(shape, p, axis);
  EXPECT_NEAR(point.gap, gap, 1e-16) << p.transpose();
  EXPECT_NEAR((normal(point) - n).norm(), 0.0, 1e-14) << p.transpose();
}

// Distance to an ellipsoid, signed for any direction of the axis.
double signed_distance(const Ellipsoid& ellipsoid, const Vector& p) {
  const double gap = met(ellipsoid, p, Vector::Zero()).gap;
  return p.cwiseQuotient(ellipsoid.half).squaredNorm() < 1.0 ? -std::abs(gap) : gap;
}

TEST(Capsule, ValuesByHand) {
  const Capsule capsule{10e-3, 20e-3};
  expect_met(capsule, {12e-3, 0.0, 5e-3}, {-1.0, 0.0, 0.0}, 2e-3, {1.0, 0.0, 0.0});
  expect_met(capsule, {0.0, -7e-3, -3e-3}, {0.0, 1.0, 0.0}, -3e-3, {0.0, -1.0, 0.0});
  expect_met(capsule, {0.0, -7e-3, -3e-3}, {0.0, -1.0, 0.0}, 3e-3, {0.0, -1.0, 0.0});  // looks away
  // Beyond the straight part by 12 mm, beside the axis by (3, 4) mm: 3, 4, 12, 13.
  expect_met(capsule, {3e-3, 4e-3, 32e-3}, {0.0, 0.0, -1.0}, 3e-3, {3.0 / 13.0, 4.0 / 13.0, 12.0 / 13.0});
  expect_met(capsule, {0.0, 6e-3, -28e-3}, {0.0, 0.0, 1.0}, 0.0, {0.0, 0.6, -0.8});
  expect_met(capsule, {0.0, 0.0, -29e-3}, {0.0, 0.0, 1.0}, -1e-3, {0.0, 0.0, -1.0});
  EXPECT_GT(met(capsule, {0.0, 0.0, 7e-3}, {1.0, 0.0, 0.0}).gap, 0.0);  // on the axis there is no nearest point
}

TEST(Capsule, WithoutAStraightPartIsASphere) {
  RandomStream draw(1, 0, "capsule");
  for (int k = 0; k < 200; ++k) {
    const Vector p = 15e-3 * draw.uniform(0.1, 1.5) * random_direction(draw), axis = random_direction(draw);
    const SurfacePoint a = met(Capsule{15e-3, 0.0}, p, axis), b = met(Sphere{15e-3}, p, axis);
    EXPECT_EQ(a.gap, b.gap);
    EXPECT_EQ(normal(a), normal(b));
  }
}

const Vector half_axes[] = {
    {30e-3, 30e-3, 30e-3}, {30e-3, 20e-3, 10e-3}, {30e-3, 30e-3, 10e-3}, {8e-3, 40e-3, 8e-3}, {1e-3, 20e-3, 5e-3}};

TEST(Ellipsoid, GapAndNormalOfAPointSetOffFromTheSurface) {
  // A point at the distance d along the normal from a point of the surface has that point as its
  // nearest one, outwards to any distance and inwards to the least radius of curvature,
  // shortest^2/longest. Rounding: the point is displaced by up to 1e-16 of the longest half axis on
  // a surface that turns its normal by 1/radius of curvature, once in the point and once more in
  // the solution.
  RandomStream draw(2, 0, "ellipsoid");
  for (const Vector& half : half_axes) {
    const Ellipsoid ellipsoid{half};
    const double bend = half.minCoeff() * half.minCoeff() / half.maxCoeff(), rounding = 1e-15 * half.maxCoeff();
    for (int k = 0; k < 2000; ++k) {
      const Vector s = random_direction(draw).cwiseProduct(half);
      const Vector n = s.cwiseQuotient(half.cwiseProduct(half)).normalized();
      const double d = k % 2 == 0 ? -0.9 * bend * draw.uniform() : draw.uniform(0.0, 2.0) * half.maxCoeff();
      const Vector p = s + d * n;
      const SurfacePoint point = met(ellipsoid, p, -n);
      ASSERT_NEAR(point.gap, d, rounding) << half.transpose() << " at " << p.transpose();
      // At 0.9 of the radius of curvature inside, the nearest point moves ten times as far as the
      // point.
      ASSERT_NEAR((normal(point) - n).norm(), 0.0, 10.0 * rounding / bend) << half.transpose() << " at " << p.transpose();
      ASSERT_NEAR(met(ellipsoid, p, n).gap, std::abs(d), rounding);
    }
  }
}

TEST(Ellipsoid, OnItsAxesTheNearestPointIsTheTip) {
  for (const Vector& half : half_axes) {
    const double bend = half.minCoeff() * half.minCoeff() / half.maxCoeff();
    for (int k = 0; k < 3; ++k) {
      const Vector out = Vector::Unit(k);
      for (const double d : {-0.5 * bend, 0.0, 1e-3}) expect_met(Ellipsoid{half}, (half[k] + d) * out, -out, d, out);
    }
  }
}

TEST(Ellipsoid, DeepInsideTheFootLiesOnTheSurfaceAndNoPointOfItIsNearer) {
  RandomStream draw(3, 0, "inside");
  for (const Vector& half : half_axes) {
    const Ellipsoid ellipsoid{half};
    for (int k = 0; k < 300; ++k) {
      const Vector p = random_direction(draw).cwiseProduct(half) * std::cbrt(draw.uniform(1e-9, 1.0));
      const Vector out = normal(met(ellipsoid, p, Vector::Zero()));
      const double gap = met(ellipsoid, p, -out).gap;
      ASSERT_LT(gap, 0.0);
      ASSERT_NEAR((p - gap * out).cwiseQuotient(half).norm(), 1.0, 1e-12) << p.transpose();
      for (int j = 0; j < 300; ++j) {
        ASSERT_GE((random_direction(draw).cwiseProduct(half) - p).norm(), -gap - 1e-17) << p.transpose();
      }
    }
  }
}

TEST(Ellipsoid, NothingIsMetFromBetweenTwoNearestPoints) {
  // The centre, and the disc of an oblate ellipsoid whose points are nearer to its top and bottom
  // than to its rim: out to a - c^2/a.
  EXPECT_GT(met(Ellipsoid{{30e-3, 20e-3, 10e-3}}, Vector::Zero(), {0.0, 0.0, -1.0}).gap, 0.0);
  EXPECT_GT(met(Ellipsoid{{30e-3, 30e-3, 10e-3}}, {26e-3, 0.0, 0.0}, {0.0, 0.0, -1.0}).gap, 0.0);
  EXPECT_GT(met(Ellipsoid{{30e-3, 30e-3, 30e-3}}, Vector::Zero(), {0.0, 0.0, -1.0}).gap, 0.0);
  EXPECT_LT(met(Ellipsoid{{30e-3, 30e-3, 10e-3}}, {27e-3, 0.0, 0.0}, {-1.0, 0.0, 0.0}).gap, 0.0);  // 30 - 100/30 = 26.67 mm
}

constexpr double difference_step = 1e-6;  // m, e below

// Central differences over 2e of a distance of size r that curves on the scale of b: e^2/b^2 and
// 1e-16 r/e at most.
template <class Shape>
void expect_normal_is_gradient(const Shape& shape, const Vector& p, double tolerance) {
  const SurfacePoint point = met(shape, p, Vector::Zero());
  const auto gap = [&](const Vector& q) { return met(shape, q, -normal(point)).gap; };
  Vector gradient;
  for (int k = 0; k < 3; ++k)
    gradient[k] =
        (gap(p + difference_step * Vector::Unit(k)) - gap(p - difference_step * Vector::Unit(k))) / (2.0 * difference_step);
  ASSERT_NEAR((gradient.normalized() - normal(point)).norm(), 0.0, tolerance) << p.transpose();
}

TEST(SurfaceShapes, NormalIsTheGradientOfTheGap) {
  // Distances of up to 50 mm that curve on the scale of 5 mm and more: (1e-6/5e-3)^2 = 4e-8, and
  // 1e-16 * 0.05/1e-6 = 5e-12. The gap of a capsule near its axis curves on the scale of the distance
  // from the axis.
  RandomStream draw(4, 0, "gradient");
  const Ellipsoid ellipsoid{{30e-3, 20e-3, 15e-3}};
  const DistanceGrid grid([&](const Vector& p) { return signed_distance(ellipsoid, p); }, -ellipsoid.half, ellipsoid.half, 2e-3);
  for (int k = 0; k < 500; ++k) {
    const double depth = draw.uniform(0.8, 1.05);
    const Vector p = depth * random_direction(draw).cwiseProduct(ellipsoid.half);
    expect_normal_is_gradient(ellipsoid, p, 4e-8);
    expect_normal_is_gradient(grid, p, 4e-8);
    const double from_axis = p.head<2>().norm();
    expect_normal_is_gradient(Capsule{15e-3, 15e-3}, p, std::max(4e-8, std::pow(difference_step / from_axis, 2)));
  }
}

// Checks that a tip at p, exactly on the faces with the normals `faces`, touches them without depth,
// or nothing, however it looks: it is at none of the faces behind it.
template <class Shape>
void expect_on_surface(const Shape& shape, const Vector& p, const std::vector<Vector>& faces) {
  RandomStream draw(17, 0, "axes");
  std::vector<Vector> axes;
  for (int k = 0; k < 3; ++k) axes.insert(axes.end(), {Vector::Unit(k), -Vector::Unit(k)});
  for (int k = 0; k < 500; ++k) axes.push_back(random_direction(draw));
  for (const Vector& axis : axes) {
    // An axis along a face is of an element that lies in it.
    if (std::ranges::any_of(faces, [&](const Vector& n) { return std::abs(n.dot(axis)) < 1e-3; })) continue;
    const double gap = met(shape, p, axis).gap;
    ASSERT_GE(gap, -1e-16) << p.transpose() << " along " << axis.transpose();
    if (std::ranges::all_of(faces, [&](const Vector& n) { return n.dot(axis) < 0.0; })) {
      ASSERT_LE(gap, 1e-16) << p.transpose() << " along " << axis.transpose();
    }
  }
}

TEST(SurfaceShapes, ATipExactlyOnTheSurfaceHasNoDepth) {
  const Vector x = Vector::UnitX(), y = Vector::UnitY(), z = Vector::UnitZ();
  const Box box{{30e-3, 20e-3, 50e-3}};
  expect_on_surface(box, {0.0, 0.0, 50e-3}, {z});
  expect_on_surface(box, {30e-3, 5e-3, -10e-3}, {x});
  expect_on_surface(box, {30e-3, 5e-3, 50e-3}, {x, z});
  expect_on_surface(box, {30e-3, -20e-3, 50e-3}, {x, -y, z});
  for (const double half : {50e-3, 5e-3, 150e-3}) {
    const Cylinder can{30e-3, half};
    for (const double end : {1.0, -1.0}) {
      for (const double r : {0.0, 10e-3, 29e-3}) expect_on_surface(can, {0.0, r, end * half}, {end * z});
      expect_on_surface(can, {30e-3, 0.0, end * half}, {x, end * z});  // on the rim
    }
    for (const double height : {0.0, 0.9 * half}) expect_on_surface(can, {0.0, -30e-3, height}, {-y});
  }
  expect_on_surface(Sphere{30e-3}, {0.0, 30e-3, 0.0}, {y});
  const Capsule capsule{10e-3, 20e-3};
  expect_on_surface(capsule, {0.0, 0.0, 30e-3}, {z});
  expect_on_surface(capsule, {10e-3, 0.0, 20e-3}, {x});  // where cylinder and half ball adjoin
  expect_on_surface(capsule, {10e-3, 0.0, 7e-3}, {x});
  const Ellipsoid ellipsoid{{30e-3, 20e-3, 10e-3}};
  for (int k = 0; k < 3; ++k) {
    expect_on_surface(ellipsoid, ellipsoid.half[k] * Vector::Unit(k), {Vector::Unit(k)});
    expect_on_surface(ellipsoid, -ellipsoid.half[k] * Vector::Unit(k), {-Vector::Unit(k)});
  }
  const oracle::Mesh mesh = oracle::box_mesh(box.half);
  const DistanceGrid grid = MeshDistance(mesh.vertices, mesh.faces).on_grid(400'000);
  expect_on_surface(grid, {29e-3, 0.0, 50e-3}, {z});
  expect_on_surface(grid, {30e-3, 5e-3, 50e-3}, {x, z});
}

TEST(Cylinder, AnElementThatPointsOutOfACapMeetsNothing) {
  // As in a box: 1 mm below the top of a cylinder of 100 mm, pointing up. Its column is unknown, so
  // it has not come from the bottom, 99 mm behind it, nor from the side, 2 mm beside it, when it
  // leans by 0.1.
  const Cylinder can{30e-3, 50e-3};
  expect_met(can, {10e-3, 0.0, 49e-3}, {0.0, 0.0, 1.0}, 1e-3, {0.0, 0.0, 1.0});
  expect_met(can, {28e-3, 0.0, 49e-3}, Vector(-0.1, 0.0, 1.0).normalized(), 1e-3, {0.0, 0.0, 1.0});
  expect_met(can, {28e-3, 0.0, 49e-3}, {-1.0, 0.0, 0.0}, -2e-3, {1.0, 0.0, 0.0});
  expect_met(can, {10e-3, 0.0, 49e-3}, {0.0, 0.0, -1.0}, -1e-3, {0.0, 0.0, 1.0});
}

TEST(DistanceGrid, CubicsAreReproduced) {
  // Far above the minimum that the distance to the box allows; the value is 100 and its slope of
  // the order of 1, so rounding is 1e-14 of it.
  const auto cubic = [](const Vector& p) {
    return 100.0 + p.x() * p.x() * p.x() - 2.0 * p.x() * p.y() * p.y() + p.x() * p.y() * p.z() + 0.5 * p.z() * p.z() + p.y() -
           3.0 * p.z();
  };
  const auto slope = [](const Vector& p) {
    return Vector(3.0 * p.x() * p.x() - 2.0 * p.y() * p.y() + p.y() * p.z(), -4.0 * p.x() * p.y() + p.x() * p.z() + 1.0,
                  p.x() * p.y() + p.z() - 3.0);
  };
  const DistanceGrid grid(cubic, {-1.0, -0.5, -0.7}, {1.0, 0.5, 0.8}, 0.13);
  RandomStream draw(5, 0, "cubic");
  for (int k = 0; k < 500; ++k) {
    const Vector p(draw.uniform(-1.3, 1.3), draw.uniform(-0.8, 0.8), draw.uniform(-1.0, 1.1));  // within the margin of 3 x 0.13
    EXPECT_NEAR(met(grid, p, {0.0, 0.0, -1.0}).gap, cubic(p), 1e-12);
    EXPECT_NEAR((normal(met(grid, p, {0.0, 0.0, -1.0})) - slope(p).normalized()).norm(), 0.0, 1e-11);
  }
}

struct Errors {
  double gap, normal;
};

// Largest errors from a third of the least radius of curvature below the surface to two cells above
// it (the grid ends at three).
Errors errors_of_grid(const Ellipsoid& ellipsoid, double cell) {
  const Vector& half = ellipsoid.half;
  const double bend = half.minCoeff() * half.minCoeff() / half.maxCoeff();
  const DistanceGrid grid([&](const Vector& p) { return signed_distance(ellipsoid, p); }, -half, half, cell);
  RandomStream draw(6, 0, "grid");
  Errors worst{0.0, 0.0};
  for (int k = 0; k < 20000; ++k) {
    const Vector s = random_direction(draw).cwiseProduct(half);
    const Vector n = s.cwiseQuotient(half.cwiseProduct(half)).normalized();
    const double d = draw.uniform(-bend / 3.0, 2.0 * cell);
    const SurfacePoint point = met(grid, s + d * n, -n);
    worst.gap = std::max(worst.gap, std::abs(point.gap - d));
    worst.normal = std::max(worst.normal, (normal(point) - n).norm());
  }
  return worst;
}

TEST(DistanceGrid, ConvergesWithTheFourthOrderInTheGapAndTheThirdInTheNormal) {
  // Half the cell: errors 16 and 8 times smaller, and more where the coarser grid is not yet in the
  // asymptotic range.
  for (const Vector& half : {Vector(30e-3, 30e-3, 30e-3), Vector(30e-3, 25e-3, 20e-3)}) {
    const double bend = half.minCoeff() * half.minCoeff() / half.maxCoeff();
    const Errors coarse = errors_of_grid({half}, bend / 8.0), fine = errors_of_grid({half}, bend / 16.0);
    EXPECT_GT(coarse.gap / fine.gap, 14.0);
    EXPECT_GT(coarse.normal / fine.normal, 7.0);
  }
}

TEST(DistanceGrid, GapIsRightToAThousandthOfARadiusOfCurvatureOfFourCells) {
  EXPECT_LT(errors_of_grid({{30e-3, 30e-3, 30e-3}}, 30e-3 / 4.0).gap, 1e-3 * 30e-3);
}

TEST(DistanceGrid, ErrorOfTheGapOfAFineGridIsThatOfACubicSpline) {
  // Along each axis at most cell^4/384 times the fourth derivative. For a distance r that is 3 (1 -
  // w)(5 w - 1)/r^3, with w the squared cosine of the angle to the axis: the three sum to at most
  // 6/r^3, on an axis. With r down to 2/3 of the radius R and cells of R/32 that is 6 (3/2)^3/(384
  // x 32^4) R = 5.03e-8 R. The next order is some (32 x 2/3)^2 times smaller.
  const double leading = 6.0 * std::pow(1.5, 3) / (384.0 * std::pow(32.0, 4)) * 30e-3;
  const double error = errors_of_grid({{30e-3, 30e-3, 30e-3}}, 30e-3 / 32.0).gap;
  EXPECT_LT(error, 1.05 * leading);
  EXPECT_GT(error, 0.8 * leading);  // the samples come close to the worst point
}

TEST(DistanceGrid, OutsideTheGapIsThatOfTheBoxAroundTheSurface) {
  const Sphere sphere{10e-3};
  const Vector half(10e-3, 10e-3, 10e-3);
  const DistanceGrid grid([&](const Vector& p) { return p.norm() - sphere.radius; }, -half, half, 1e-3);
  expect_met(grid, {14e-3, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 4e-3, {1.0, 0.0, 0.0});
  expect_met(grid, {0.0, -1.0, 9e-3}, {1.0, 0.0, 0.0}, 0.99, {0.0, -1.0, 0.0});
  expect_met(grid, {13e-3, -14e-3, 0.0}, {1.0, 0.0, 0.0}, 5e-3, {0.6, -0.8, 0.0});
  RandomStream draw(7, 0, "outside");
  for (int k = 0; k < 2000; ++k) {
    const Vector p = draw.uniform(10e-3, 40e-3) * random_direction(draw);
    const double gap = met(grid, p, random_direction(draw)).gap;
    EXPECT_GT(gap, 0.0);
    EXPECT_LT(gap, p.norm() - sphere.radius + 1e-6);  // with cells of a tenth of the radius the grid is exact to 36/384e4 of it
  }
}

TEST(DistanceGrid, CopiesShareTheSamples) {
  const DistanceGrid grid([](const Vector& p) { return p.norm() - 1.0; }, {-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}, 0.1);
  const Surface surface = grid, copy = surface;
  EXPECT_EQ(std::get<DistanceGrid>(copy).samples(), grid.samples());
  EXPECT_EQ(grid.cell(), 0.1);
  EXPECT_EQ(grid.nodes(), 29U * 29U * 29U);  // 20 cells and 3 on either side; 3 coefficients more than cells
}

TEST(DistanceGrid, RefusesWhatItCannotHold) {
  const auto ball = [](const Vector& p) { return p.norm() - 1.0; };
  const Vector one(1.0, 1.0, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(DistanceGrid(ball, -one, one, 0.1));
  EXPECT_THROW(DistanceGrid(ball, -one, one, 0.0), std::invalid_argument);
  EXPECT_THROW(DistanceGrid(ball, -one, one, nan), std::invalid_argument);
  EXPECT_THROW(DistanceGrid(ball, -one, one, 1e-9), std::invalid_argument);
  EXPECT_THROW(DistanceGrid(ball, one, -one, 0.1), std::invalid_argument);
  EXPECT_THROW(DistanceGrid(ball, -one, Vector(nan, 1.0, 1.0), 0.1), std::invalid_argument);
  EXPECT_THROW(DistanceGrid(ball, -0.9 * one, 0.9 * one, 0.1), std::invalid_argument);  // the ball protrudes
  EXPECT_THROW(DistanceGrid([&](const Vector&) { return nan; }, -one, one, 0.1), std::invalid_argument);
}

TEST(DistanceGrid, CellForANumberOfSamples) {
  // 10 cells along a cube of 1 m are 10 + 2 x 3 + 1 nodes, plus 3 samples on either side: 23 along
  // each axis.
  const Vector one(1.0, 1.0, 1.0);
  EXPECT_NEAR(DistanceGrid::cell_for(one, 23 * 23 * 23), 0.1, 1e-12);
  EXPECT_GT(DistanceGrid::cell_for(one, 23 * 23 * 23 - 1), 0.11);  // one cell less: 1/9
}

// The signed distance to a box; inside it is that to the nearest face.
double signed_distance(const Box& box, const Vector& p) {
  const Vector out = p.cwiseAbs() - box.half;
  return out.maxCoeff() > 0.0 ? out.cwiseMax(0.0).norm() : out.maxCoeff();
}

TEST(MeshDistance, CubeIsABox) {
  const Box box{{30e-3, 20e-3, 50e-3}};
  const oracle::Mesh mesh = oracle::box_mesh(box.half);
  const MeshDistance distance(mesh.vertices, mesh.faces);
  RandomStream draw(8, 0, "cube");
  for (int k = 0; k < 20000; ++k) {
    const Vector p(draw.uniform(-60e-3, 60e-3), draw.uniform(-40e-3, 40e-3), draw.uniform(-80e-3, 80e-3));
    ASSERT_NEAR(distance(p), signed_distance(box, p), 1e-16) << p.transpose();
  }
}

TEST(MeshDistance, HollowsAreHollow) {
  // An L of two boxes, [-2, 2] x [-1, 1] x [-2, 0] and [-2, 0] x [-1, 1] x [-2, 2] mm: outside, the
  // distance is the smaller of theirs. The convex hull would fill the notch above (1, 0, 1).
  const oracle::Mesh mesh = oracle::l_mesh(1e-3);
  const MeshDistance distance(mesh.vertices, mesh.faces);
  const auto boxes = [](const Vector& p) {
    return std::min(signed_distance(Box{{2e-3, 1e-3, 1e-3}}, p - Vector(0.0, 0.0, -1e-3)),
                    signed_distance(Box{{1e-3, 1e-3, 2e-3}}, p - Vector(-1e-3, 0.0, 0.0)));
  };
  RandomStream draw(9, 0, "hollow");
  int outside = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vector p(draw.uniform(-3e-3, 3e-3), draw.uniform(-2e-3, 2e-3), draw.uniform(-3e-3, 3e-3));
    const double expected = boxes(p);
    if (expected > 0.0) {
      ++outside;
      ASSERT_NEAR(distance(p), expected, 1e-17) << p.transpose();
    } else {
      ASSERT_LE(distance(p), expected + 1e-17) << p.transpose();  // the face between the boxes does not count
    }
  }
  EXPECT_GT(outside, 1000);
  EXPECT_NEAR(distance({0.5e-3, 0.0, 0.5e-3}), 0.5e-3, 1e-18);
}

TEST(MeshDistance, BesideSharpEdgesAndTipsTheSideIsThatOfTheWholeMesh) {
  // A leaning spike: beyond its tip and along its edges the nearest point belongs both to faces
  // that point away and to others. Points below all four faces are inside.
  const oracle::Mesh spike{{{0.0, 0.0, 0.0}, {2e-3, 0.0, 0.0}, {0.0, 1e-3, 0.0}, {9e-3, 2e-3, 6e-3}},
                           {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  const MeshDistance distance(spike.vertices, spike.faces);
  RandomStream draw(12, 0, "spike");
  for (int k = 0; k < 20000; ++k) {
    const Vector p(draw.uniform(-2e-3, 11e-3), draw.uniform(-2e-3, 4e-3), draw.uniform(-2e-3, 8e-3));
    double highest = -1.0;  // m, above the plane of a face
    for (const auto& [a, b, c] : spike.faces) {
      const Vector n = (spike.vertices[b] - spike.vertices[a]).cross(spike.vertices[c] - spike.vertices[a]).normalized();
      highest = std::max(highest, n.dot(p - spike.vertices[a]));
    }
    // Inside, the nearest face is that of the least depth; outside, the mesh is no nearer than any
    // face plane with the mesh below it.
    if (highest < 0.0) {
      ASSERT_NEAR(distance(p), highest, 1e-17) << p.transpose();
    } else {
      ASSERT_GE(distance(p), highest - 1e-17) << p.transpose();
    }
  }
}

TEST(MeshDistance, GridOfACubeIsABoxAwayFromItsEdges) {
  // A spline reproduces a linear distance and reads up to 4 cells away along each axis. At a depth of
  // up to 2 cells it reads down to 6, and 10 from the edges it reads to within 6 of them, where two
  // faces are equally near.
  const Box box{{30e-3, 20e-3, 50e-3}};
  const oracle::Mesh mesh = oracle::box_mesh(box.half);
  const DistanceGrid grid = MeshDistance(mesh.vertices, mesh.faces).on_grid(400'000);
  const double cell = grid.cell(), from_edge = 10.0 * cell;
  EXPECT_LT(cell, 1.5e-3);
  RandomStream draw(10, 0, "cube");
  for (int k = 0; k < 2000; ++k) {
    const Vector p(draw.uniform(-1.0, 1.0) * (box.half.x() - from_edge), draw.uniform(-1.0, 1.0) * (box.half.y() - from_edge),
                   box.half.z() + draw.uniform(-2.0, 2.0) * cell);
    const SurfacePoint a = met(grid, p, {0.0, 0.0, -1.0}), b = met(box, p, {0.0, 0.0, -1.0});
    ASSERT_NEAR(a.gap, b.gap, 1e-15);
    ASSERT_NEAR((normal(a) - normal(b)).norm(), 0.0, 1e-12);
  }
}

TEST(MeshDistance, GridOfABallOfTrianglesIsABall) {
  // 20 x 4^4 triangles of a ball of 30 mm: a chord of length c lies c^2/(8 R) below its arc, the
  // middle of a triangle 4/3 of that. Edges are 63.4 degrees/2^4, 30 mm x 1.107/16 = 2.1 mm, times
  // 1.2 for the longest: 36 um.
  const oracle::Mesh mesh = oracle::ball_mesh(30e-3, 4);
  EXPECT_EQ(mesh.faces.size(), 5120U);
  const DistanceGrid grid = MeshDistance(mesh.vertices, mesh.faces).on_grid(400'000);
  RandomStream draw(11, 0, "ball");
  for (int k = 0; k < 2000; ++k) {
    const double d = draw.uniform(-2e-3, 2e-3);
    const Vector out = random_direction(draw), p = (30e-3 + d) * out;
    const SurfacePoint point = met(grid, p, -out);
    ASSERT_NEAR(point.gap, d + 18e-6, 18e-6 + 1e-6) << p.transpose();
    ASSERT_NEAR((normal(point) - out).norm(), 0.0, 0.5 * 2.5e-3 / 30e-3) << p.transpose();  // half an edge of a triangle
  }
}

TEST(MeshDistance, RefusesWhatHasNoInside) {
  const oracle::Mesh cube = oracle::box_mesh({1e-3, 1e-3, 1e-3});
  const auto make = [](const oracle::Mesh& mesh) { return MeshDistance(mesh.vertices, mesh.faces); };
  EXPECT_NO_THROW(make(cube));

  oracle::Mesh open = cube;
  open.faces.pop_back();
  EXPECT_THAT(refusal_of([&] { make(open); }), mentions({"18", "3", "0"}));
  oracle::Mesh doubled = cube;
  doubled.faces.push_back(doubled.faces.front());
  EXPECT_THAT(refusal_of([&] { make(doubled); }), mentions({"3", "face"}));
  oracle::Mesh against = cube;
  std::swap(against.faces.front()[0], against.faces.front()[1]);
  EXPECT_THAT(refusal_of([&] { make(against); }), mentions({"0", "3", "opposite"}));
  oracle::Mesh turned = cube;
  for (MeshDistance::Face& face : turned.faces) std::swap(face[0], face[1]);
  EXPECT_THAT(refusal_of([&] { make(turned); }), HasSubstr("inside out"));
  oracle::Mesh wrong = cube;
  wrong.faces.front()[1] = 8;
  EXPECT_THAT(refusal_of([&] { make(wrong); }), mentions({"vertex 8"}));
  oracle::Mesh infinite = cube;
  infinite.vertices.front().x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal_of([&] { make(infinite); }), HasSubstr("not finite"));
  EXPECT_THAT(refusal_of([&] { make({cube.vertices, {}}); }), HasSubstr("no faces"));
}

// Checks points in and around the meshes below, which are a few mm large.
template <class Expected>
void expect_distance(const oracle::Mesh& mesh, double tolerance, const Expected& expected) {
  const MeshDistance distance(mesh.vertices, mesh.faces);
  RandomStream draw(13, 0, "points");
  for (int k = 0; k < 20000; ++k) {
    const Vector p(draw.uniform(-4e-3, 4e-3), draw.uniform(-4e-3, 4e-3), draw.uniform(-4e-3, 4e-3));
    ASSERT_NEAR(distance(p), expected(p), tolerance) << p.transpose();
  }
}

TEST(MeshDistance, VerticesWithinAMillionthOfTheExtentAreOne) {
  // Each face of a box of 2 x 3 x 4 mm has its own corners, as in files of triangles: up to 2
  // sqrt(3) times the rounding apart, 3.5 nm of the 4 nm that are welded. A distance changes by at
  // most the shift of the corners. Further apart they leave the mesh open.
  const Box box{{1e-3, 1.5e-3, 2e-3}};
  const oracle::Mesh mesh = oracle::box_mesh(box.half);
  for (const double rounding : {0.0, 1e-9}) {
    expect_distance(oracle::unwelded(mesh, rounding), std::sqrt(3.0) * rounding + 1e-17,
                    [&](const Vector& p) { return signed_distance(box, p); });
  }
  const oracle::Mesh apart = oracle::unwelded(mesh, 1e-8);
  EXPECT_THAT(refusal_of([&] { MeshDistance(apart.vertices, apart.faces); }), HasSubstr("not closed"));
}

TEST(MeshDistance, FacesWithoutWidthLookNowhere) {
  // A cube whose upper edge at y = -1 mm has an extra vertex: two front triangles meet there, and a
  // face from corner to corner to that vertex closes the gap to the top. The vertex is out of line
  // by 1 nm, half of the welding distance, to either side: that face points to the front or back,
  // or into the cube, depending on rounding.
  const Box box{{1e-3, 1e-3, 1e-3}};
  for (const Vector& out_of_line :
       {Vector(0, 1e-9, 0), Vector(0, -1e-9, 0), Vector(0, 0, 1e-9), Vector(0, 0, -1e-9), Vector(0, 0, 0)}) {
    oracle::Mesh mesh = oracle::box_mesh(box.half);
    mesh.vertices.push_back(Vector(0.3e-3, -1e-3, 1e-3) + out_of_line);
    auto& front = mesh.faces[5];  // {1, 5, 4}, whose edge from 5 to 4 is the upper one
    ASSERT_EQ(front, (MeshDistance::Face{1, 5, 4}));
    front = {1, 5, 8};
    mesh.faces.push_back({1, 8, 4});
    mesh.faces.push_back({4, 8, 5});
    expect_distance(mesh, 1e-9, [&](const Vector& p) { return signed_distance(box, p); });
  }
}

TEST(MeshDistance, ShellsMayTouchAndLookEitherWay) {
  // Two cubes with one common edge, which four faces share; and two separate ones, of which the
  // smaller is inside out. Outside, the distance is that of the nearer cube; inside it is that of
  // its own faces.
  const Box large{{1e-3, 1e-3, 1e-3}}, small{{0.5e-3, 0.5e-3, 0.5e-3}};
  const auto nearer = [&](const Vector& shift) {
    return [&, shift](const Vector& p) { return std::min(signed_distance(large, p), signed_distance(small, p - shift)); };
  };
  const oracle::Mesh cube = oracle::box_mesh(large.half);
  oracle::Mesh other = oracle::box_mesh(small.half);
  const Vector touching(1.5e-3, 1.5e-3, 0.5e-3), apart(2e-3, 2e-3, 2e-3);
  expect_distance(oracle::both(cube, other, touching), 1e-17, nearer(touching));
  oracle::Mesh twin = oracle::both(cube, cube, {2e-3, 2e-3, 0.0});
  expect_distance(twin, 1e-17, [&](const Vector& p) {
    return std::min(signed_distance(large, p), signed_distance(large, p - Vector(2e-3, 2e-3, 0.0)));
  });
  for (MeshDistance::Face& face : other.faces) std::swap(face[0], face[1]);
  expect_distance(oracle::both(cube, other, apart), 1e-17, nearer(apart));
}

DistanceGrid grid_of(const oracle::Mesh& mesh) { return MeshDistance(mesh.vertices, mesh.faces).on_grid(100'000); }

TEST(MeshDistance, OnBothSidesOfAWallTheDepthIsThatBelowTheFace) {
  // The middle of a facet of a mug of 40 mm and 180 facets is at the radius R cos(pi/180), and one
  // of the hollow at (R - w) cos(pi/180). Up to the middle of the wall the depth below either is
  // that of the point. Cells are over 2 mm, so that walls have half a cell to two.
  constexpr double radius = 40e-3;
  constexpr std::uint32_t sides = 180;
  const double to_facet = std::cos(M_PI / sides);
  for (const double wall : {5e-3, 3.5e-3, 3e-3, 1e-3}) {
    const DistanceGrid grid = grid_of(oracle::can_mesh(radius, 90e-3, sides, wall));
    EXPECT_GT(grid.cell(), 2e-3);
    RandomStream draw(14, 0, "wall");
    for (int k = 0; k < 500; ++k) {
      const double angle = 2.0 * M_PI * (std::floor(draw.uniform(0.0, sides)) + 0.5) / sides, z = draw.uniform(20e-3, 70e-3);
      const Vector out(std::cos(angle), std::sin(angle), 0.0);
      // the wall is a little thinner at the middle of a facet
      const double depth = 0.49 * wall * to_facet * draw.uniform();
      const SurfacePoint outer = met(grid, (radius * to_facet - depth) * out + Vector(0.0, 0.0, z), -out);
      ASSERT_NEAR(outer.gap, -depth, 1e-15) << wall << " at " << angle;
      ASSERT_NEAR((normal(outer) - out).norm(), 0.0, 1e-9);
      const SurfacePoint inner = met(grid, ((radius - wall) * to_facet + depth) * out + Vector(0.0, 0.0, z), out);
      ASSERT_NEAR(inner.gap, -depth, 1e-15) << wall << " at " << angle;
      ASSERT_NEAR((normal(inner) + out).norm(), 0.0, 1e-9);
    }
  }
}

TEST(MeshDistance, APlateMayBeThinnerThanACell) {
  // 100 x 100 mm: 100,000 samples are at most 7,700 in each of the 13 layers that any grid has, so
  // cells are over 100 mm/sqrt(7,700) = 1.1 mm.
  for (const double thickness : {0.7e-3, 0.2e-3, 0.02e-3}) {
    const DistanceGrid grid = grid_of(oracle::box_mesh({50e-3, 50e-3, 0.5 * thickness}));
    EXPECT_GT(grid.cell(), 1.1e-3);
    RandomStream draw(15, 0, "plate");
    for (int k = 0; k < 500; ++k) {
      const double x = draw.uniform(-45e-3, 45e-3), y = draw.uniform(-45e-3, 45e-3), gap = thickness * draw.uniform(-0.49, 2.0);
      expect_met(grid, {x, y, 0.5 * thickness + gap}, {0.0, 0.0, -1.0}, gap, {0.0, 0.0, 1.0});
      expect_met(grid, {x, y, -0.5 * thickness - gap}, {0.0, 0.0, 1.0}, gap, {0.0, 0.0, -1.0});
    }
  }
}

TEST(MeshDistance, InAGapBetweenTwoWallsTheNearerOneIsMet) {
  // Two plates, 10 mm thick, 3 mm apart: two to three cells.
  const Vector half(30e-3, 30e-3, 5e-3);
  const DistanceGrid grid = grid_of(oracle::both(oracle::box_mesh(half), oracle::box_mesh(half), {0.0, 0.0, 13e-3}));
  EXPECT_LT(3e-3, 3.0 * grid.cell());
  for (const double gap : {-1e-3, -0.2e-3, 0.0, 0.2e-3, 1e-3, 1.4e-3}) {
    expect_met(grid, {1e-3, 2e-3, 5e-3 + gap}, {0.0, 0.0, -1.0}, gap, {0.0, 0.0, 1.0});
    expect_met(grid, {1e-3, 2e-3, 8e-3 - gap}, {0.0, 0.0, 1.0}, gap, {0.0, 0.0, -1.0});
  }
}

TEST(MeshDistance, BesideAnEdgeTheDepthIsThatBelowTheFace) {
  // As in a box: the element presses on the face that it entered, though the next one is nearer, and
  // up to half a cell beside the spline.
  const Box box{{30e-3, 20e-3, 50e-3}};
  const DistanceGrid grid = grid_of(oracle::box_mesh(box.half));
  for (const double lean : {0.0, 0.1, -0.1}) {
    const Vector axis(std::sin(lean), 0.0, -std::cos(lean));
    for (const double from_edge : {0.2e-3, 0.3e-3, 1e-3, 4e-3, 8e-3}) {
      for (const double depth : {0.1e-3, 0.45e-3, 1.5e-3, 3e-3, 5e-3}) {
        const Vector p(30e-3 - from_edge, 1e-3, 50e-3 - depth);
        const SurfacePoint mesh = grid.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z(), 10e-3);
        const SurfacePoint wanted = box.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z(), 10e-3);
        EXPECT_NEAR(mesh.gap, wanted.gap, 1e-12) << lean << ", " << from_edge << ", " << depth;
        EXPECT_NEAR((normal(mesh) - normal(wanted)).norm(), 0.0, 1e-9) << lean << ", " << from_edge << ", " << depth;
      }
    }
  }
}

TEST(MeshDistance, HiddenFacesAreNotMet) {
  // Two cubes of 20 mm side by side, overlapping by 2 and 0.5 mm or touching, and a plate of 1 mm sunk
  // by 0.5 mm into the top of a cube: everywhere the depth is that below the top.
  const Vector half(10e-3, 10e-3, 10e-3), down(0.0, 0.0, -1.0), up(0.0, 0.0, 1.0);
  for (const double overlap : {2e-3, 0.5e-3, 0.0}) {
    const DistanceGrid grid = grid_of(oracle::both(oracle::box_mesh(half), oracle::box_mesh(half), {20e-3 - overlap, 0.0, 0.0}));
    for (double x = 5e-3; x < 15e-3; x += 0.0997e-3) {
      for (const double depth : {0.1e-3, 0.5e-3, 1.5e-3}) expect_met(grid, {x, 0.3e-3, 10e-3 - depth}, down, -depth, up);
    }
  }
  const DistanceGrid sunk =
      grid_of(oracle::both(oracle::box_mesh(half), oracle::box_mesh({10e-3, 10e-3, 0.5e-3}), {0.0, 0.0, 10e-3}));
  for (const double depth : {0.1e-3, 0.45e-3, 0.6e-3, 0.8e-3, 1.2e-3}) {
    expect_met(sunk, {1e-3, 2e-3, 10.5e-3 - depth}, down, -depth, up);
  }
}

TEST(MeshDistance, BeyondTheMiddleOfAPlateTheFirstFaceIsMet) {
  // Whatever its thickness, until the tip leaves at the other side.
  for (const double thickness : {2e-3, 0.2e-3, 0.02e-3}) {
    const DistanceGrid grid = grid_of(oracle::box_mesh({50e-3, 50e-3, 0.5 * thickness}));
    for (const double part : {0.3, 0.6, 0.95}) {
      const SurfacePoint point = grid.at(1e-3, 2e-3, (0.5 - part) * thickness, 0.0, 0.0, -1.0, 4e-3);
      EXPECT_NEAR(point.gap, -part * thickness, 1e-12) << thickness << ", " << part;
      EXPECT_EQ(point.nz, 1.0);
    }
  }
}

TEST(MeshDistance, AMeshOfSliversIsRefused) {
  // A needle of 1 m x 0.1 um, whose faces are all narrower than a millionth of its length.
  const double w = 0.1e-6;
  const std::vector<Vector> vertices{{0.0, 0.0, 0.0}, {0.5, w, 0.0}, {0.6, 0.0, w}, {1.0, 0.0, 0.0}};
  std::vector<MeshDistance::Face> faces{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  if (vertices[1].cross(vertices[2]).dot(vertices[3]) < 0.0) {
    for (MeshDistance::Face& face : faces) std::swap(face[1], face[2]);
  }
  EXPECT_THROW(MeshDistance(vertices, faces), InputError);
}

TEST(MeshDistance, DetailsSmallerThanACellAreSeen) {
  // A ridge of 0.3 x 0.3 mm on a block of 60 x 60 x 20 mm, whose cells are over 1 mm.
  const DistanceGrid grid = grid_of(
      oracle::both(oracle::box_mesh({30e-3, 30e-3, 10e-3}), oracle::box_mesh({0.15e-3, 20e-3, 0.3e-3}), {0.11e-3, 0.0, 10e-3}));
  EXPECT_GT(grid.cell(), 1e-3);
  for (const double depth : {-0.1e-3, 0.05e-3, 0.1e-3}) {
    expect_met(grid, {0.11e-3, 5e-3, 10.3e-3 - depth}, {0.0, 0.0, -1.0}, -depth, {0.0, 0.0, 1.0});
  }
}

TEST(MeshDistance, WithoutKinksNearbyTheGridIsTheSplineAlone) {
  // Bit-identical to the spline through the distances: the facets of a ball of 1,280 triangles turn
  // by about 8 degrees, and a tip is far from the middle of the ball.
  const oracle::Mesh mesh = oracle::ball_mesh(30e-3, 3);
  const MeshDistance distance(mesh.vertices, mesh.faces);
  const DistanceGrid grid = distance.on_grid(100'000);
  Vector low = mesh.vertices.front(), high = low;
  for (const Vector& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const DistanceGrid spline(distance, low, high, grid.cell());
  RandomStream draw(16, 0, "ball");
  for (int k = 0; k < 2000; ++k) {
    const Vector out = random_direction(draw), p = draw.uniform(25e-3, 32e-3) * out;
    ASSERT_FALSE(grid.is_exact(p)) << p.transpose();
    const SurfacePoint a = met(grid, p, -out), b = met(spline, p, -out);
    ASSERT_EQ(a.gap, b.gap);
    ASSERT_EQ(normal(a), normal(b));
  }
  EXPECT_TRUE(grid.is_exact(Vector::Zero()));
}

TEST(MeshDistance, GapIsContinuousWhereTheSplineBegins) {
  // Along the side of a can, from its rim to its middle, 0.2 mm below the facets. In steps of 1 um
  // the gap changes by no more than the two distances differ times 1 um/cell, 20 nm: the corner of a
  // facet is R (1 - cos(pi/180)) = 5 um above its middle, and the spline is in between.
  const DistanceGrid grid = grid_of(oracle::can_mesh(33e-3, 115e-3, 180));
  const double radius = 33e-3 * std::cos(M_PI / 180.0);
  const Vector out(std::cos(M_PI / 180.0), std::sin(M_PI / 180.0), 0.0);
  double before = 0.0;
  int exact = 0, steps = 0;
  for (double z = 114e-3; z > 60e-3; z -= 1e-6, ++steps) {
    const Vector p = (radius - 0.2e-3) * out + Vector(0.0, 0.0, z);
    const double gap = met(grid, p, -out).gap;
    exact += grid.is_exact(p) ? 1 : 0;
    ASSERT_NEAR(gap, -0.2e-3, 5e-6);
    if (steps > 0) {
      ASSERT_NEAR(gap, before, 20e-9) << z;
    }
    before = gap;
  }
  EXPECT_GT(exact, 1000);
  EXPECT_LT(exact, steps / 2);
}

}  // namespace
}  // namespace slipbench
