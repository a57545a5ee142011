// Position of a scene's shapes in the world.

#include <cstddef>
#include <variant>

#include <gtest/gtest.h>

#include "sim/stage/step_plan.h"
#include "tests/sim/stage/simulation_rig.h"

namespace slipbench::testing_bench {
namespace {

// Gap [m] and world normal at a point of the world, for an element that faces down.
std::pair<double, Eigen::Vector3d> met(const PlacedSurface& placed, const Eigen::Vector3d& world) {
  const Eigen::Vector3d p = placed.pose.inverse() * world,
                        axis = placed.pose.rotation.transpose() * Eigen::Vector3d(0.0, 0.0, -1.0);
  const SurfacePoint point =
      std::visit([&](const auto& shape) { return shape.at(p.x(), p.y(), p.z(), axis.x(), axis.y(), axis.z()); }, placed.shape);
  return {point.gap, placed.pose.rotation * Eigen::Vector3d(point.nx, point.ny, point.nz)};
}

PlacedSurface placed(const std::string& name, const Changes& changes = {}) {
  const auto& catalogue = surface_catalogue();
  const auto& kind =
      *std::find_if(catalogue.begin(), catalogue.end(), [&](const SurfaceKind& k) { return k.about.name == name; });
  return kind.create(named(catalogue, name, changes).parameters);
}

TEST(Surfaces, HighestPointOfEveryShapeIsAtZeroOverItsPosition) {
  const std::vector<double> position{4e-3, -7e-3};
  for (const SurfaceKind& kind : surface_catalogue()) {
    const bool movable = kind.about.name != "plane";
    const PlacedSurface surface = placed(kind.about.name, movable ? Changes{{"position", position}} : Changes{});
    for (const double z : {1e-3, 1e-6, -1e-6, -1e-3}) {
      const auto [gap, normal] = met(surface, {4e-3, -7e-3, z});
      EXPECT_NEAR(gap, z, 1e-15) << kind.about.name;
      EXPECT_NEAR((normal - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12) << kind.about.name;
    }
  }
}

TEST(Surfaces, EntriesAreDocumented) {
  for (const SurfaceKind& kind : surface_catalogue()) {
    EXPECT_FALSE(kind.about.summary.empty() || kind.about.law.empty()) << kind.about.name;
    for (const ParameterSpec& parameter : kind.about.parameters) {
      EXPECT_FALSE(parameter.doc.empty() || parameter.source.empty()) << kind.about.name << "." << parameter.name;
    }
  }
}

TEST(Surfaces, BoxHasItsSize) {
  const PlacedSurface box = placed("box", {{"size", std::vector<double>{20e-3, 10e-3, 6e-3}}});
  EXPECT_NEAR(met(box, {11e-3, 0.0, -1e-3}).first, 1e-3, 1e-15);
  EXPECT_NEAR(met(box, {0.0, -7e-3, -1e-3}).first, 2e-3, 1e-15);
  EXPECT_NEAR(met(box, {0.0, 0.0, -9e-3}).first, 3e-3, 1e-15);
}

TEST(Surfaces, CylinderLiesAlongItsAngle) {
  // Radius 30 mm: at the distance s from its highest line the gap is sqrt(s^2 + 30^2) - 30 mm.
  // Along the line it is zero up to the end at half its length.
  for (const double angle : {0.0, 0.5, -1.2}) {
    const PlacedSurface cylinder = placed("cylinder", {{"angle", angle}, {"length", 80e-3}});
    const Eigen::Vector3d along(std::cos(angle), std::sin(angle), 0.0), across(-std::sin(angle), std::cos(angle), 0.0);
    EXPECT_NEAR(met(cylinder, 39e-3 * along).first, 0.0, 1e-15);
    EXPECT_NEAR(met(cylinder, -42e-3 * along - Eigen::Vector3d(0.0, 0.0, 1e-3)).first, 2e-3, 1e-15);
    EXPECT_NEAR(met(cylinder, 5e-3 * across).first, std::hypot(5e-3, 30e-3) - 30e-3, 1e-15);
  }
}

TEST(Surfaces, UprightCylinderHasItsEndFaceUp) {
  // Diameter 18 mm: 0.5 mm inside the rim the face applies, 1 mm outside it and 1 mm below the
  // side.
  const PlacedSurface post = placed("upright_cylinder", {{"radius", 9e-3}, {"length", 20e-3}});
  for (const double angle : {0.0, 0.8, 3.0}) {
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0.0);
    const auto [depth, up] = met(post, 8.9e-3 * out - Eigen::Vector3d(0.0, 0.0, 0.5e-3));
    EXPECT_NEAR(depth, -0.5e-3, 1e-15);
    EXPECT_NEAR((up - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-15);
    const auto [beside, outwards] = met(post, 10e-3 * out - Eigen::Vector3d(0.0, 0.0, 1e-3));
    EXPECT_NEAR(beside, 1e-3, 1e-15);
    EXPECT_NEAR((outwards - out).norm(), 0.0, 1e-12);
  }
}

TEST(Surfaces, CapsuleLiesAlongItsAngleAndEndsInHalfBalls) {
  // Radius 30 mm, straight for 40 mm either way. On the straight part the highest line is at 0; 18
  // mm beyond its end, 24 mm above the axis, is the half ball: 18, 24, 30.
  for (const double angle : {0.0, 0.5, -1.2}) {
    const PlacedSurface capsule = placed("capsule", {{"angle", angle}, {"length", 80e-3}});
    const Eigen::Vector3d along(std::cos(angle), std::sin(angle), 0.0), across(-std::sin(angle), std::cos(angle), 0.0);
    EXPECT_NEAR(met(capsule, 39e-3 * along).first, 0.0, 1e-15);
    EXPECT_NEAR(met(capsule, 58e-3 * along - Eigen::Vector3d(0.0, 0.0, 6e-3)).first, 0.0, 1e-15);
    EXPECT_NEAR(met(capsule, -72e-3 * along - Eigen::Vector3d(0.0, 0.0, 30e-3)).first, 2e-3, 1e-15);
    EXPECT_NEAR(met(capsule, 5e-3 * across).first, std::hypot(5e-3, 30e-3) - 30e-3, 1e-15);
  }
}

TEST(Surfaces, SphereHasItsRadius) {
  const PlacedSurface sphere = placed("sphere", {{"radius", 25e-3}});
  EXPECT_NEAR(met(sphere, {5e-3, 0.0, 0.0}).first, std::hypot(5e-3, 25e-3) - 25e-3, 1e-15);
}

TEST(TickTimes, AreQuotientsOfWholeNumbersWhereTheStepIsAnNthOfASecond) {
  const TickTimes milliseconds(0.001), tenths(0.0001);
  for (std::size_t k = 0; k < 60'000; ++k) ASSERT_EQ(milliseconds.at(k), tenths.at(10 * k)) << k;
  EXPECT_EQ(milliseconds.at(9), 0.009);  // the double next to 9/1000, as decimal text is read
  EXPECT_NE(9.0 * 0.001, 0.009);         // the reason for TickTimes
  EXPECT_EQ(TickTimes(1.0 / 2400.0).at(24), 0.01);
}

TEST(TickTimes, AreMultiplesOfAStepThatIsNone) {
  EXPECT_EQ(TickTimes(0.0003).at(7), 7.0 * 0.0003);  // 3,333.3 per second
  EXPECT_EQ(TickTimes(2.0).at(3), 6.0);
}

}  // namespace

}  // namespace slipbench::testing_bench
