// Surfaces of compiled geoms against MuJoCo's own distances, and meshes where MuJoCo's distances do
// not apply.
#include <limits>
#include <variant>

#include <fmt/format.h>

#include "sim/core/random.h"
#include "sim/mujoco/pads/geom_surface.h"
#include "tests/expect.h"
#include "tests/oracle/meshes.h"
#include "tests/sim/mujoco/pads/models.h"

namespace slipbench {
namespace {

constexpr double probe_radius = 1e-6;  // m, MuJoCo measures between geoms, so a point is a small sphere

// A world with one geom, "touched" (geom 0), and the probe (geom 1).
class World {
 public:
  explicit World(const std::string& geom, const std::string& asset = "") {
    const std::string xml = "<mujoco><asset>" + asset + "</asset><worldbody><geom name='touched' " + geom +
                            "/><geom type='sphere' size='" + std::to_string(probe_radius) + "'/></worldbody></mujoco>";
    model_ = compile(parse(xml).get());
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
  }

  [[nodiscard]] mjModel* model() const { return model_.get(); }

  // MuJoCo's distance to a point of the world.
  double distance(const Eigen::Vector3d& point) {
    mju_copy3(data_->geom_xpos + 3, point.data());
    return mj_geomDistance(model_.get(), data_.get(), 0, 1, 1.0, nullptr) + probe_radius;
  }

  // Pose of the surface in the world.
  [[nodiscard]] Pose pose(const GeomSurface& surface) const {
    return pose_of(data_->geom_xpos, data_->geom_xmat) * surface.in_geom;
  }

 private:
  Model model_;
  Data data_;
};

// The surface point for an element at `point` of the world with the axis `axis`.
SurfacePoint met(const Surface& shape, const Pose& pose, const Eigen::Vector3d& point, const Eigen::Vector3d& axis) {
  const Eigen::Vector3d p = pose.inverse() * point, a = pose.rotation.transpose() * axis;
  return std::visit([&](const auto& s) { return s.at(p.x(), p.y(), p.z(), a.x(), a.y(), a.z()); }, shape);
}

const std::string turned = " pos='0.1 -0.2 0.3' euler='20 -40 70'";

// Compares points around the turned geom, at up to twice its size `reach` [m], with MuJoCo's
// distance to `tolerance` [m]. Outside only: inside, MuJoCo uses the nearest face and slipbench the
// one that was entered.
template <class Shape>
void compare(const std::string& geom, double reach, double tolerance) {
  World world(geom + turned);
  const GeomSurface surface = surface_of_geom(world.model(), 0);
  ASSERT_TRUE(std::holds_alternative<Shape>(surface.shape));
  const Pose pose = world.pose(surface);
  RandomStream draw(1, 0, "points");
  int compared = 0;
  while (compared < 1000) {
    const Eigen::Vector3d point =
        pose.position + 2.0 * reach * Eigen::Vector3d(draw.uniform(-1.0, 1.0), draw.uniform(-1.0, 1.0), draw.uniform(-1.0, 1.0));
    const double theirs = world.distance(point);
    if (theirs < 0.0) continue;
    ++compared;
    ASSERT_NEAR(met(surface.shape, pose, point, {0.0, 0.0, -1.0}).gap, theirs, tolerance) << geom << " at " << point.transpose();
  }
}

TEST(GeomSurface, DistancesAreThoseOfMuJoCo) {
  compare<Plane>("type='plane' size='1 1 1'", 0.05, 1e-9);
  compare<Box>("type='box' size='0.03 0.02 0.05'", 0.05, 1e-9);
  compare<Sphere>("type='sphere' size='0.03'", 0.03, 1e-9);
  compare<Cylinder>("type='cylinder' size='0.03 0.05'", 0.05, 1e-9);
  compare<Capsule>("type='capsule' size='0.03 0.05'", 0.08, 1e-9);
  compare<Ellipsoid>("type='ellipsoid' size='0.03 0.02 0.05'", 0.05, 1e-6);  // MuJoCo iterates to 1e-6
}

// On both sides of the surface, where the nearest face is also the one entered along the axis, so
// that both distances agree.
TEST(GeomSurface, DepthsAreThoseOfMuJoCoWhereOneFaceIsMeant) {
  struct Case {
    std::string geom;
    Eigen::Vector3d low, high;  // m
  };
  for (const Case& one : {Case{"type='plane' size='1 1 1'", {-0.05, -0.05, -0.002}, {0.05, 0.05, 0.002}},
                          Case{"type='sphere' size='0.03'", {-0.01, -0.01, 0.026}, {0.01, 0.01, 0.032}},
                          Case{"type='box' size='0.03 0.02 0.05'", {-0.025, -0.015, 0.048}, {0.025, 0.015, 0.052}},
                          Case{"type='cylinder' size='0.03 0.05'", {-0.015, -0.015, 0.048}, {0.015, 0.015, 0.052}}}) {
    World world(one.geom);
    const GeomSurface surface = surface_of_geom(world.model(), 0);
    const Pose pose = world.pose(surface);
    RandomStream draw(1, 0, "points");
    for (int i = 0; i < 2000; ++i) {
      Eigen::Vector3d point;
      for (int k = 0; k < 3; ++k) point[k] = draw.uniform(one.low[k], one.high[k]);
      ASSERT_NEAR(met(surface.shape, pose, point, {0.0, 0.0, -1.0}).gap, world.distance(point), 1e-9)
          << one.geom << " at " << point.transpose();
    }
  }
}

TEST(GeomSurface, APlaneHasNoEnd) {
  World world("type='plane' size='0.01 0.01 0.01'");
  const GeomSurface surface = surface_of_geom(world.model(), 0);
  EXPECT_EQ(met(surface.shape, world.pose(surface), {5.0, 7.0, -1e-3}, {0.0, 0.0, -1.0}).gap, -1e-3);
}

// The mesh in MJCF, with `shift` [m] added to every vertex.
std::string asset(const oracle::Mesh& mesh, const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  std::string vertices, faces;
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    for (int k = 0; k < 3; ++k) vertices += fmt::format("{} ", vertex[k] + shift[k]);
  }
  for (const auto& face : mesh.faces) {
    for (const std::uint32_t corner : face) faces += std::to_string(corner) + " ";
  }
  return "<mesh name='shape' inertia='shell' vertex='" + vertices + "' face='" + faces + "'/>";
}

// The pose written in `turned`.
Pose as_written() {
  Pose written;
  written.position = {0.1, -0.2, 0.3};
  const auto angle = [](double degrees, const Eigen::Vector3d& axis) { return Eigen::AngleAxisd(degrees * M_PI / 180.0, axis); };
  written.rotation =
      (angle(20, Eigen::Vector3d::UnitX()) * angle(-40, Eigen::Vector3d::UnitY()) * angle(70, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  return written;
}

TEST(GeomSurface, MeshStandsWhereItsVerticesWereWritten) {
  // The compiler centres a mesh and turns it to its principal axes, so the box below returns with
  // its axes in another order and the geom with another pose; in the world it is unchanged.
  // Vertices are floats: 6e-8 of 0.15 m.
  const Box box{{0.03, 0.02, 0.05}};
  const Eigen::Vector3d shift(0.1, 0.05, -0.02);
  World world("type='mesh' mesh='shape'" + turned, asset(oracle::box_mesh(box.half), shift));
  const GeomSurface surface = surface_of_geom(world.model(), 0);
  const double cell = std::get<DistanceGrid>(surface.shape).cell();
  const Pose written = as_written();
  const Pose pose = world.pose(surface);
  RandomStream draw(2, 0, "mesh");
  for (int k = 0; k < 1000; ++k) {
    // More than 10 cells from the edges of the face x = 30 mm, where the grid is exact.
    const Eigen::Vector3d p(0.03 + draw.uniform(-2.0, 2.0) * cell, draw.uniform(-1.0, 1.0) * (0.02 - 10.0 * cell),
                            draw.uniform(-1.0, 1.0) * (0.05 - 10.0 * cell));
    const Eigen::Vector3d axis = written.rotation * Eigen::Vector3d(-1.0, 0.0, 0.0);
    const SurfacePoint point = met(surface.shape, pose, written * (p + shift), axis);
    ASSERT_NEAR(point.gap, p.x() - 0.03, 3e-8);
    ASSERT_NEAR((pose.rotation * Eigen::Vector3d(point.nx, point.ny, point.nz) + axis).norm(), 0.0, 1e-6);
  }
}

TEST(GeomSurface, UnweldedMeshIsWeldedByTheSizeOfItsRounding) {
  // A box of 60 x 40 x 100 mm whose faces have separate corners some nanometres apart, as in files
  // of triangles with few digits. Over the middle of the face x = 30 mm the gap is that of the box.
  const Box box{{0.03, 0.02, 0.05}};
  const oracle::Mesh mesh = oracle::unwelded(oracle::box_mesh(box.half), 30e-9);
  World world("type='mesh' mesh='shape'" + turned, asset(mesh));
  const GeomSurface surface = surface_of_geom(world.model(), 0);
  const Pose written = as_written();
  for (const double gap : {-1e-3, 0.0, 1e-3}) {
    const SurfacePoint point = met(surface.shape, world.pose(surface), written * Eigen::Vector3d(0.03 + gap, 1e-3, 2e-3),
                                   written.rotation * Eigen::Vector3d(-1.0, 0.0, 0.0));
    EXPECT_NEAR(point.gap, gap, 30e-9 + 10e-9);  // and floats
  }
}

TEST(GeomSurface, MeshIsNotItsConvexHull) {
  // In the notch of an L of units of 10 mm, at (2, 0, 2) mm from its inner edge: 2 mm from both
  // faces. MuJoCo fills the notch up to the line from (20, 0) to (0, 20) mm, 16/sqrt(2) mm above
  // the point.
  World world("type='mesh' mesh='shape'", asset(oracle::l_mesh(10e-3)));
  const GeomSurface surface = surface_of_geom(world.model(), 0);
  const Eigen::Vector3d point(2e-3, 0.0, 2e-3);
  EXPECT_LT(world.distance(point), -5e-3);
  // Vertices are floats: 6e-8 of 20 mm.
  EXPECT_NEAR(met(surface.shape, world.pose(surface), point, {0.0, 0.0, -1.0}).gap, 2e-3, 2e-9);
}

TEST(GeomSurface, MeshesOfTheSameTrianglesShareAGrid) {
  const std::string box = asset(oracle::box_mesh({0.03, 0.02, 0.05}));
  World one("type='mesh' mesh='shape'", box), another("type='mesh' mesh='shape'" + turned, box);
  World other("type='mesh' mesh='shape'", asset(oracle::box_mesh({0.03, 0.02, 0.04})));
  const auto samples = [](const World& world) {
    return std::get<DistanceGrid>(surface_of_geom(world.model(), 0).shape).samples();
  };
  const auto kept = samples(one);
  EXPECT_EQ(samples(another), kept);
  EXPECT_NE(samples(other), kept);
}

void expect_refused(const World& world, const std::vector<std::string>& words) {
  const std::string said = refusal_of([&] { surface_of_geom(world.model(), 0); });
  EXPECT_THAT(said, refused_at("geom 'touched'", words));
}

TEST(GeomSurface, SizesThatAreNotPositiveAreRefused) {
  // As a program may set them in a compiled model.
  World world("type='cylinder' size='0.03 0.05'");
  EXPECT_NO_THROW(surface_of_geom(world.model(), 0));
  for (const double size : {0.0, -0.05, std::numeric_limits<double>::quiet_NaN()}) {
    world.model()->geom_size[1] = size;
    expect_refused(world, {"size 1", "positive"});
  }
}

TEST(GeomSurface, OtherGeomsAreRefusedByName) {
  expect_refused(World("type='hfield' hfield='hills'", "<hfield name='hills' nrow='2' ncol='2' size='1 1 1 1'/>"),
                 {"height field", "plane", "box", "sphere", "cylinder", "capsule", "ellipsoid", "mesh"});
  oracle::Mesh open = oracle::box_mesh({0.03, 0.02, 0.05});
  open.faces.pop_back();
  expect_refused(World("type='mesh' mesh='shape'", asset(open)), {"mesh 'shape'", "holes"});
  World world("type='sphere' size='0.03'");
  EXPECT_THROW(surface_of_geom(world.model(), 2), std::invalid_argument);
  EXPECT_THROW(surface_of_geom(world.model(), -1), std::invalid_argument);
}

}  // namespace
}  // namespace slipbench
