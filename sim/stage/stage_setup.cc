#include "sim/stage/stage_setup.h"

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/math/rotation.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"
#include "sim/effects/effect_catalogue.h"
#include "sim/effects/install.h"
#include "sim/grasp/grasp.h"
#include "sim/motion/motion_catalogue.h"
#include "sim/scene/catalogues.h"
#include "sim/scene/materials.h"

namespace slipbench {
namespace {

// Returns the catalogue entry `name`. The parser has accepted only names that exist.
template <class Catalogue>
const auto& kind_named(const Catalogue& catalogue, const std::string& name) {
  return *std::find_if(catalogue.begin(), catalogue.end(), [&](const auto& kind) { return kind.about.name == name; });
}

ParameterSpec position() {
  return vector_spec(2, "position", Quantity::length, "[0 mm, 0 mm]", any_value,
                     "Position of the surface's middle along the world's X and Y.", "set for each scene");
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
  return number_spec("angle", Quantity::angle, "0 deg", any_value, "Direction of the axis, from the world's X axis.",
                     "set for each scene");
}

// Places the shape with its z axis along the angle, and its highest line at z = 0.
Pose lying(const Parameters& p) {
  Pose pose = placed(p, -p.number("radius"));
  pose.rotation = rotation_by_axes({0.0, 0.5 * std::numbers::pi, p.number("angle")});
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
           "A lying cylinder with hemispherical ends, whose highest line is z = 0.",
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

std::vector<ParameterSpec> place() {
  return {
      vector_spec(3, "position", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                  "Position of the body's middle at the start, in the world.", "set for each scene"),
      vector_spec(3, "rotation", Quantity::angle, "[0 deg, 0 deg, 0 deg]", any_value,
                  "Rotation at the start: about the world's X axis, then Y, then Z.", "set for each scene"),
      number_spec(
          "friction", Quantity::none, "0.5", {0.0, 100.0},
          "Friction coefficient of MuJoCo's own contact with other bodies; the larger of the two bodies' values applies. Pads do not use it.",
          "assumed")};
}

// Returns the entry of a body that may be free, with the parameters of its size first.
Entry shape(std::string name, std::string summary, std::vector<ParameterSpec> sizes) {
  const std::vector<ParameterSpec> motion{
      number_spec("mass", Quantity::mass, "100 g", positive, "Mass, spread evenly.", "assumed"),
      flag_spec("free", "true", "True: forces move the body; false: it stands still.", "set for each scene"),
      vector_spec(3, "velocity", Quantity::speed, "[0 m/s, 0 m/s, 0 m/s]", any_value,
                  "Velocity of the body's middle at the start; 0 for a body that is not free.", "set for each scene")};
  return {std::move(name), std::move(summary), "", "", joined(joined(std::move(sizes), place()), motion)};
}

}  // namespace

void add_sim_catalogues(Catalogues& catalogues) {
  catalogues.materials = material_table();
  for (const SurfaceKind& kind : surface_catalogue()) catalogues.surfaces.push_back(kind.about);
  for (const MotionKind& kind : motion_catalogue()) {
    catalogues.motions.push_back(kind.about);
    if (kind.of_arm) catalogues.arm_motions.push_back(kind.about.name);
  }
  catalogues.bodies = body_catalogue();
  catalogues.grasp = grasp_catalogue();
  catalogues.protocols = protocol_catalogue();
  for (const EffectKind& kind : effect_catalogue()) catalogues.effects.push_back(kind.about);
}

std::unique_ptr<Motion> make_motion(const Scene& scene, std::uint64_t trial) {
  return kind_named(motion_catalogue(), scene.motion.name).create(scene.motion.parameters, {scene.seed, trial});
}

void refuse_motors(const Motion& motion) {
  if (!motion.motors()) return;
  throw SceneValueError("motion.vibration", "needs fidelity field and the stage; in this scene it must be 0");
}

StageSetup set_up_stage(const Scene& scene, std::uint64_t trial) {
  return {make_motion(scene, trial), kind_named(surface_catalogue(), scene.surface.name).create(scene.surface.parameters)};
}

void refuse_inside(const PadLayout& pad, const PlacedSurface& surface, const FieldEffects& effects, const Pose& pose) {
  const Pose pad_in_surface = surface.pose.inverse() * pose;
  double depth = 0.0;
  for (const Element& element : pad.elements) {
    const Eigen::Vector3d tip = pad_in_surface * element.tip;
    const Eigen::Vector3d axis = pad_in_surface.rotation * element.axis;
    const SurfacePoint met =
        std::visit([&](const auto& s) { return s.at(tip.x(), tip.y(), tip.z(), axis.x(), axis.y(), axis.z()); }, surface.shape);
    const double x = tip.x() - met.gap * met.nx, y = tip.y() - met.gap * met.ny;
    double gap = met.gap;
    for (const auto& effect : effects.surface) effect->displace(1, &x, &y, &met.nz, &gap);
    depth = std::max(depth, -gap);
  }
  if (depth > 0.0) {
    throw SceneValueError("motion.gap",
                          fmt::format("the pad starts {} inside the surface; increase the gap by more than this length",
                                      readable_quantity(depth, Quantity::length)));
  }
}

StepLimit step_limit(const Motion& motion, const FieldEffects& effects, double reach) {
  const double resolved = longest_step(effects, motion.top_speed(reach)), straight = motion.longest_step();
  return straight < resolved ? StepLimit{straight, "the motion, whose path within a step must be nearly straight"}
                             : StepLimit{resolved, "the scene's effects"};
}

double reach_of(const PadLayout& layout) {
  double reach = 0.0;
  for (const Element& element : layout.elements) reach = std::max(reach, element.tip.norm());
  return reach;
}

const std::vector<SurfaceKind>& surface_catalogue() {
  static const std::vector<SurfaceKind> kinds{
      plane(), box(), cylinder(), upright_cylinder(), capsule(), sphere(),
  };
  return kinds;
}

const std::vector<Entry>& body_catalogue() {
  static const std::vector<Entry> shapes{
      shape("box", "A box.",
            {vector_spec(3, "size", Quantity::length, "[40 mm, 40 mm, 60 mm]", positive, "Extent along X, Y, Z.", "assumed"),
             vector_spec(3, "centre_of_mass", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                         "Centre of mass, from the body's middle. The inertia about it is that of an even box about its middle.",
                         "assumed"),
             number_spec("weight", Quantity::mass, "0 g", non_negative,
                         "Mass of a weight in the box, in addition to the box's own mass.", "set for each scene"),
             vector_spec(3, "weight_place", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                         "Position of the weight, a point mass, from the box's middle.", "set for each scene")}),
      shape("capsule", "A cylinder along Z with hemispherical ends.",
            {number_spec("radius", Quantity::length, "20 mm", positive, "Radius.", "assumed"),
             number_spec("length", Quantity::length, "60 mm", positive, "Length of the straight part.", "assumed")}),
      shape("cylinder", "A cylinder along Z.",
            {number_spec("radius", Quantity::length, "20 mm", positive, "Radius.", "assumed"),
             number_spec("length", Quantity::length, "60 mm", positive, "Length.", "assumed"),
             number_spec("bore", Quantity::length, "0 mm", non_negative,
                         "Radius of a hole along the axis, below `radius`. It changes only the inertia, as of a drinking glass.",
                         "set for each scene"),
             vector_spec(
                 3, "centre_of_mass", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                 "Centre of mass, from the body's middle. The inertia about it is that of an even cylinder about its middle.",
                 "assumed")}),
      shape("ellipsoid", "An ellipsoid.",
            {vector_spec(3, "size", Quantity::length, "[40 mm, 40 mm, 60 mm]", positive, "Extent along X, Y, Z.", "assumed")}),
      {"plane", "An endless plane along the world's X and Y at the start; it stands still.", "", "", place()},
      shape("sphere", "A ball.", {number_spec("radius", Quantity::length, "30 mm", positive, "Radius.", "assumed")}),
  };
  return shapes;
}

}  // namespace slipbench
