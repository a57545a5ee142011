// Objects thinner than the indentation: the force is that of the face where the element entered, or
// the loss is reported.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "sim/contact/surface/mesh_distance.h"
#include "sim/contact/surface/thickness.h"
#include "tests/oracle/meshes.h"
#include "tests/oracle/pads.h"
#include "tests/sim/contact/random_case.h"

namespace slipbench::testing_field::thin_surface_test {
namespace {

constexpr double k_n = 7100.0, k_t = 3900.0, height = 5e-3;

// One pillar of 5 mm.
PadLayout pillar() {
  PadLayout pad = oracle::square_grid(1, 0.0, k_n, k_t);
  pad.unit_height = height;
  return pad;
}

// Presses from 0.1 mm above the top of a shape at z = `top` down to `depth`; calls look(depth now).
template <class Look>
void press(Field& field, double top, double depth, const Look& look, double tilt = 0.0) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
  for (double z = 0.1e-3; z >= -depth - 1e-9; z -= 0.01e-3) {
    field.step({turn, {0.0, 0.0, top + z}}, 1e-3);
    look(-z);
  }
}

TEST(ThinSurface, CardsPressBackWithDepthTimesStiffness) {
  // k_n d for any thickness of the card, and k_n d cos(tilt) / cos(tilt) for a tilted pillar: d
  // counts along the card's normal.
  for (const double thickness : {2e-3, 1e-3, 0.9e-3, 0.5e-3, 0.3e-3, 0.05e-3}) {
    for (const double tilt : {0.0, 0.2}) {
      const Box card{{20e-3, 20e-3, 0.5 * thickness}};
      const Cylinder disc{20e-3, 0.5 * thickness};
      for (const Surface& surface : {Surface(card), Surface(disc)}) {
        Field field(pillar(), surface, {0.5, 0.5});
        press(
            field, 0.5 * thickness, 0.8e-3,
            [&](double depth) {
              ASSERT_NEAR(field.normal_force(0), k_n * std::max(0.0, depth), 1e-9) << thickness << " " << tilt << " " << depth;
              ASSERT_FALSE(field.lost());
            },
            tilt);
        // Moved sideways by 0.1 mm it is held by k_t u, on the same anchor.
        const Pose pressed = field.pad_in_surface();
        field.step({pressed.rotation, pressed.position + Eigen::Vector3d(0.0, 0.1e-3, 0.0)}, 1e-3);
        EXPECT_NEAR(field.tangential_force(0).norm(), k_t * 0.1e-3, 1e-9);
        // Lifted, it detaches at the top.
        for (double z = -0.8e-3; z < 0.02e-3; z += 0.01e-3) {
          field.step({pressed.rotation, {0.0, 0.1e-3, 0.5 * thickness + z}}, 1e-3);
          ASSERT_NEAR(field.normal_force(0), k_n * std::max(0.0, -z), 1e-9);
        }
        EXPECT_EQ(field.touching(), 0U);
        EXPECT_FALSE(field.lost());
      }
    }
  }
}

TEST(ThinSurface, AFilmIsNotSteppedOver) {
  // 10 um thick, and 30 um per step.
  Field field(pillar(), Box{{20e-3, 20e-3, 5e-6}}, {0.5, 0.5});
  for (int k = 0; k <= 10; ++k) field.step(at(0.0, 0.0, 5e-6 + 0.1e-3 - 3e-5 * k), 1e-3);
  EXPECT_NEAR(field.normal_force(0), k_n * 0.2e-3, 1e-9);
}

TEST(ThinSurface, ACardSweptInFromTheSideGivesNothing) {
  // With its tip below the card, the column enters from the side: no face of the card was pressed.
  Field field(pillar(), Box{{10e-3, 10e-3, 0.25e-3}}, {0.5, 0.5});
  for (int k = 0; k <= 400; ++k) {
    field.step(at(-12e-3 + 1e-5 * k, 0.0, 0.25e-3 - 0.8e-3), 1e-3);
    ASSERT_EQ(field.normal_force(0), 0.0) << k;
  }
}

TEST(ThinSurface, AFrictionlessWayThroughACardGivesNoWork) {
  // Down, sideways over the edge, up beside it and back in: the elastic energy is returned, and no
  // more.
  Field field(pillar(), Box{{10e-3, 10e-3, 0.25e-3}}, {0.0, 0.0});
  double work = 0.0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), place(0.0, 0.0, 0.35e-3);
  const auto go_to = [&](const Eigen::Vector3d& there) {
    const Eigen::Vector3d from = place;
    for (int k = 1; k <= 1000; ++k) {
      const Eigen::Vector3d next = from + (there - from) * (k / 1000.0);
      field.step(at(next.x(), next.y(), next.z()), 1e-3);
      const Eigen::Vector3d now = field.normal(0) * field.normal_force(0);
      work += 0.5 * (force + now).dot(next - place);
      force = now;
      place = next;
    }
  };
  go_to({0.0, 0.0, -0.55e-3});
  EXPECT_NEAR(work, -0.5 * k_n * 0.8e-3 * 0.8e-3, 1e-8);
  go_to({12e-3, 0.0, -0.55e-3});
  go_to({12e-3, 0.0, 0.35e-3});
  go_to({0.0, 0.0, 0.35e-3});
  EXPECT_LE(work, 1e-12);
}

TEST(ThinSurface, ColumnsEndAtTheirHeight) {
  // Pressed in further than its height, the pillar is no longer a spring and its force vanishes.
  // This is reported.
  Field field(pillar(), Box{{20e-3, 20e-3, 0.5e-3}}, {0.5, 0.5});
  bool lost = false;
  press(field, 0.5e-3, height + 0.2e-3, [&](double depth) {
    lost = lost || field.lost();
    if (depth < height) {
      EXPECT_FALSE(lost) << depth;
    }
  });
  EXPECT_TRUE(lost);
}

TEST(ThinSurface, RoundBodiesTellWhenAnElementHasComeThrough) {
  const double r = 0.7e-3;
  PadLayout unknown = oracle::square_grid(1, 0.0, k_n, k_t);  // without a known height
  struct Case {
    Surface surface;
    double top;
    PadLayout pad;
    double x;  // m, beside the middle
  };
  const oracle::Mesh plate = oracle::box_mesh({5e-3, 4e-3, r});
  const DistanceGrid grid = MeshDistance(plate.vertices, plate.faces).on_grid(400'000);
  const std::vector<Case> cases{{grid, r, pillar(), 0.3e-3},
                                {grid, r, unknown, 0.3e-3},
                                {Sphere{r}, r, pillar(), 0.05e-3},
                                {Sphere{r}, r, pillar(), 0.0},
                                {Capsule{r, 2e-3}, 2e-3 + r, pillar(), 0.01e-3},
                                {Ellipsoid{{r, 2.0 * r, 3.0 * r}}, 3.0 * r, pillar(), 0.1e-3},
                                {Box{{5e-3, 5e-3, r}}, r, unknown, 0.0},
                                {Cylinder{5e-3, r}, r, unknown, 0.0}};
  for (const Case& each : cases) {
    Field field(each.pad, each.surface, {0.5, 0.5});
    std::size_t lost = 0;
    double force = 0.0;
    for (double z = 0.1e-3; z > -2.5 * each.top && lost == 0; z -= 0.0101e-3) {
      force = field.normal_force(0);
      field.step(at(each.x, 0.0, each.top + z), 1e-3);
      lost += field.lost() ? 1U : 0U;
      if (field.touching() == 0 && force > 0.0) {
        EXPECT_EQ(lost, 1U);
        EXPECT_NEAR(field.lost()->depth, force / k_n, 1e-12);
      }
    }
    EXPECT_EQ(lost, 1U) << &each - cases.data();
  }
}

TEST(ThinSurface, AMeshTellsWhenAWallOfAnyThicknessWasPassed) {
  // In steps of a quarter of the wall a tip is deepest at the last quarter. In one step over the
  // whole wall it never touches. A leaning axis does not matter, nor does the way back out.
  for (const double thickness : {2e-3, 0.2e-3, 0.02e-3}) {
    const oracle::Mesh plate = oracle::box_mesh({20e-3, 20e-3, 0.5 * thickness});
    const DistanceGrid grid = MeshDistance(plate.vertices, plate.faces).on_grid(100'000);
    for (const double tilt : {0.0, 0.7, 1.1}) {
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
      const auto height = [&](double gap) { return Pose{turn, {0.0, 0.0, 0.5 * thickness + gap}}; };
      const PadLayout pad = oracle::square_grid(1, 0.0, k_n, k_t);
      Field slow(pad, grid, {0.5, 0.5}), fast(pad, grid, {0.5, 0.5}), back(pad, grid, {0.5, 0.5});
      for (const double part : {-0.1, 0.15, 0.4, 0.65, 0.9}) {
        slow.step(height(-part * thickness), 1e-3);
        ASSERT_FALSE(slow.lost()) << thickness << ", " << tilt << ", " << part;
        ASSERT_NEAR(slow.penetration(0), std::max(0.0, part) * thickness, 1e-12);
      }
      slow.step(height(-1.15 * thickness), 1e-3);
      ASSERT_TRUE(slow.lost()) << thickness << ", " << tilt;
      EXPECT_NEAR(slow.lost()->depth, 0.9 * thickness, 1e-12);
      for (const double gap : {0.1, -1.2}) fast.step(height(gap * thickness), 1e-3);
      EXPECT_TRUE(fast.lost()) << thickness << ", " << tilt;
      for (const double gap : {0.1, -0.9, 0.2}) {
        back.step(height(gap * thickness), 1e-3);
        EXPECT_FALSE(back.lost()) << thickness << ", " << tilt;
      }
    }
  }
}

TEST(ThinSurface, WhoLeavesAMeshByAnEdgeIsNotLost) {
  // Neither does an element that the side of the mesh moves over get its depth for nothing.
  const oracle::Mesh cube = oracle::box_mesh({10e-3, 10e-3, 10e-3});
  const DistanceGrid grid = MeshDistance(cube.vertices, cube.faces).on_grid(100'000);
  for (const double tilt : {0.0, 0.1, -0.1}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
    Field field(pillar(), grid, {0.5, 0.5});
    for (int k = 0; k <= 40; ++k) field.step({turn, {9e-3, 0.0, 10e-3 + 0.1e-3 - 1e-5 * k}}, 1e-3);
    for (int k = 0; k <= 200; ++k) {
      field.step({turn, {9e-3 + 1e-5 * k, 0.0, 10e-3 - 0.3e-3}}, 1e-3);
      ASSERT_FALSE(field.lost()) << tilt << " " << k;
      if (k < 95) {
        ASSERT_NEAR(field.penetration(0), 0.3e-3, 1e-9) << tilt << " " << k;
      }
    }
    EXPECT_EQ(field.touching(), 0U);
    for (int k = 0; k <= 100; ++k) field.step({turn, {11e-3 - 1.5e-5 * k, 0.0, 10e-3 - 0.3e-3}}, 1e-3);
    EXPECT_LT(field.penetration(0), 30e-6) << tilt;
  }
}

TEST(ThinSurface, WhoLeavesByAnEdgeOrByTheFaceIsNotLost) {
  for (const double tilt : {0.0, 0.1, -0.1}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
    for (const Surface& surface :
         {Surface(Box{{10e-3, 10e-3, 10e-3}}), Surface(Cylinder{10e-3, 10e-3}), Surface(Box{{10e-3, 10e-3, 0.2e-3}})}) {
      const double top = 0.5 * std::min(20e-3, thickness_of(surface));
      Field field(pillar(), surface, {0.5, 0.5});
      for (int k = 0; k <= 40; ++k) field.step({turn, {9e-3, 0.0, top + 0.1e-3 - 1e-5 * k}}, 1e-3);
      ASSERT_EQ(field.touching(), 1U);
      for (int k = 0; k <= 200; ++k) {
        field.step({turn, {9e-3 + 1e-5 * k, 0.0, top - 0.3e-3}}, 1e-3);
        ASSERT_FALSE(field.lost()) << tilt << " " << k;
      }
      EXPECT_EQ(field.touching(), 0U);
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_field::thin_surface_test
