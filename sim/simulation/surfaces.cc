#include "sim/simulation/surfaces.h"

#include <numbers>

namespace slipbench {
namespace {

ParameterSpec position() {
  return vector_spec(2, "position", Quantity::length, "[0 mm, 0 mm]", any_value,
                     "Position of the surface's middle along the world's X and Y.", "free");
}

Pose placed(const Parameters& p, double z) {
  Pose pose;
  pose.position = {p.vector("position")[0], p.vector("position")[1], z};
  return pose;
}

SurfaceKind plane() {
  return {{"plane", "An endless plane, z = 0.", "gap = z", "", {}}, [](const Parameters&) {
            return PlacedSurface{Plane{}, Pose{}};
          }};
}

SurfaceKind box() {
  return {{"box",
           "A box whose top face is z = 0.",
           "gap = distance to the face through which the element entered",
           "",
           {vector_spec(3, "size", Quantity::length, "[60 mm, 60 mm, 100 mm]", positive, "Extent along X, Y, Z.", "assumed"),
            position()}},
          [](const Parameters& p) {
            const Eigen::Vector3d half = 0.5 * Eigen::Vector3d(p.vector("size")[0], p.vector("size")[1], p.vector("size")[2]);
            return PlacedSurface{Box{half}, placed(p, -half.z())};
          }};
}

ParameterSpec angle() {
  return number_spec("angle", Quantity::angle, "0 deg", any_value, "Direction of the axis, from the world's X axis.", "free");
}

// With the shape's z axis along the angle, and its highest line at z = 0.
Pose lying(const Parameters& p) {
  Pose pose = placed(p, -p.number("radius"));
  pose.rotation = (Eigen::AngleAxisd(p.number("angle"), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  return pose;
}

SurfaceKind cylinder() {
  return {{"cylinder",
           "A lying cylinder whose highest line is z = 0.",
           "gap = distance to its axis - radius",
           "",
           {number_spec("radius", Quantity::length, "30 mm", positive, "Radius.", "assumed"),
            number_spec("length", Quantity::length, "100 mm", positive, "Length.", "assumed"), angle(), position()}},
          [](const Parameters& p) {
            return PlacedSurface{Cylinder{p.number("radius"), 0.5 * p.number("length")}, lying(p)};
          }};
}

SurfaceKind upright_cylinder() {
  return {{"upright_cylinder",
           "An upright cylinder whose upper end face is z = 0.",
           "gap = distance to the face through which the element entered",
           "",
           {number_spec("radius", Quantity::length, "30 mm", positive, "Radius.", "assumed"),
            number_spec("length", Quantity::length, "100 mm", positive, "Length.", "assumed"), position()}},
          [](const Parameters& p) {
            const double half_length = 0.5 * p.number("length");
            return PlacedSurface{Cylinder{p.number("radius"), half_length}, placed(p, -half_length)};
          }};
}

SurfaceKind capsule() {
  return {{"capsule",
           "A lying cylinder with half a ball at either end, whose highest line is z = 0.",
           "gap = distance to the straight part of its axis - radius",
           "",
           {number_spec("radius", Quantity::length, "30 mm", positive, "Radius.", "assumed"),
            number_spec("length", Quantity::length, "100 mm", positive, "Length of the straight part.", "assumed"), angle(),
            position()}},
          [](const Parameters& p) {
            return PlacedSurface{Capsule{p.number("radius"), 0.5 * p.number("length")}, lying(p)};
          }};
}

SurfaceKind sphere() {
  return {{"sphere",
           "A sphere whose highest point is z = 0.",
           "gap = distance to its centre - radius",
           "",
           {number_spec("radius", Quantity::length, "30 mm", positive, "Radius.", "assumed"), position()}},
          [](const Parameters& p) {
            return PlacedSurface{Sphere{p.number("radius")}, placed(p, -p.number("radius"))};
          }};
}

}  // namespace

const std::vector<SurfaceKind>& surface_catalogue() {
  static const std::vector<SurfaceKind> kinds{
      plane(), box(), cylinder(), upright_cylinder(), capsule(), sphere(),
  };
  return kinds;
}

}  // namespace slipbench
