// Our analytic distances against MuJoCo's, an implementation that shares nothing with ours.
#include <array>
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include "sim/core/random.h"
#include "sim/field/surface/surface.h"

namespace slipbench {
namespace {

constexpr double probe_radius = 1e-6;  // m, MuJoCo measures between geoms, so a point is a small sphere

struct Freed {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};

// A world with one shape (geom 0) and the probe (geom 1).
class World {
 public:
  explicit World(const std::string& shape) {
    const std::string xml =
        "<mujoco><worldbody>" + shape + "<geom type='sphere' size='" + std::to_string(probe_radius) + "'/></worldbody></mujoco>";
    std::array<char, 500> error{};
    spec_.reset(mj_parseXMLString(xml.c_str(), nullptr, error.data(), static_cast<int>(error.size())));
    EXPECT_NE(spec_, nullptr) << error.data();
    model_.reset(mj_compile(spec_.get(), nullptr));
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
  }

  double distance(double x, double y, double z) {
    const double point[3] = {x, y, z};
    mju_copy3(data_->geom_xpos + 3, point);
    return mj_geomDistance(model_.get(), data_.get(), 0, 1, 1.0, nullptr) + probe_radius;
  }

 private:
  std::unique_ptr<mjSpec, Freed> spec_;
  std::unique_ptr<mjModel, Freed> model_;
  std::unique_ptr<mjData, Freed> data_;
};

// Points within 2 mm of the surface at angles where the nearest face is also the one that faces the axis, so that both speak of the same
// distance. MuJoCo's convex collision is exact to its tolerance of 1e-6 relative; analytic pairs are exact.
template <class Shape>
void compare(const std::string& xml, const Shape& shape, const std::array<double, 3>& low, const std::array<double, 3>& high) {
  World world(xml);
  RandomStream stream(1, 0, "points");
  for (int i = 0; i < 2000; ++i) {
    const double x = stream.uniform(low[0], high[0]), y = stream.uniform(low[1], high[1]), z = stream.uniform(low[2], high[2]);
    EXPECT_NEAR(shape.at(x, y, z, 0.0, 0.0, -1.0).gap, world.distance(x, y, z), 1e-9) << x << ' ' << y << ' ' << z;
  }
}

TEST(SurfaceDistance, Plane) {
  compare("<geom type='plane' size='1 1 1'/>", Plane{}, {-0.05, -0.05, -0.002}, {0.05, 0.05, 0.002});
}

TEST(SurfaceDistance, Sphere) {
  compare("<geom type='sphere' size='0.03'/>", Sphere{0.03}, {-0.01, -0.01, 0.026}, {0.01, 0.01, 0.032});
}

TEST(SurfaceDistance, BoxTop) {
  compare("<geom type='box' size='0.03 0.02 0.05'/>", Box{{0.03, 0.02, 0.05}}, {-0.025, -0.015, 0.048}, {0.025, 0.015, 0.052});
}

TEST(SurfaceDistance, BoxEdgeFromOutside) {
  compare("<geom type='box' size='0.03 0.02 0.05'/>", Box{{0.03, 0.02, 0.05}}, {0.025, 0.015, 0.0501}, {0.035, 0.025, 0.052});
}

TEST(SurfaceDistance, CylinderCap) {
  compare("<geom type='cylinder' size='0.03 0.05'/>", Cylinder{0.03, 0.05}, {-0.015, -0.015, 0.048}, {0.015, 0.015, 0.052});
}

TEST(SurfaceDistance, CylinderRimFromOutside) {
  compare("<geom type='cylinder' size='0.03 0.05'/>", Cylinder{0.03, 0.05}, {0.02, 0.02, 0.0501}, {0.03, 0.03, 0.052});
}

}  // namespace
}  // namespace slipbench
