#include "sim/simulation/bodies.h"

#include <string>
#include <utility>

namespace slipbench {
namespace {

std::vector<ParameterSpec> place() {
  return {
      vector_spec(3, "position", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                  "Position of the body's middle at the start, in the world.", "free"),
      vector_spec(3, "rotation", Quantity::angle, "[0 deg, 0 deg, 0 deg]", any_value,
                  "Rotation at the start: about the world's X axis, then Y, then Z.", "free"),
      number_spec(
          "friction", Quantity::none, "0.5", {0.0, 100.0},
          "Friction coefficient of MuJoCo's own contact with other bodies; of two bodies that meet the larger counts. Pads do not use it.",
          "assumed")};
}

// A body that may be free, with the parameters of its size in front.
Entry shape(std::string name, std::string summary, std::vector<ParameterSpec> sizes) {
  const std::vector<ParameterSpec> motion{
      number_spec("mass", Quantity::mass, "100 g", positive, "Mass, spread evenly.", "assumed"),
      flag_spec("free", "true", "Whether forces move the body; otherwise it stands still.", "free"),
      vector_spec(3, "velocity", Quantity::speed, "[0 m/s, 0 m/s, 0 m/s]", any_value,
                  "Velocity of the body's middle at the start; 0 for a body that is not free.", "free")};
  return {std::move(name), std::move(summary), "", "", joined(joined(std::move(sizes), place()), motion)};
}

}  // namespace

const std::vector<Entry>& body_catalogue() {
  static const std::vector<Entry> shapes{
      shape("box", "A box.",
            {vector_spec(3, "size", Quantity::length, "[40 mm, 40 mm, 60 mm]", positive, "Extent along X, Y, Z.", "assumed"),
             vector_spec(3, "centre_of_mass", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                         "Centre of mass, from the body's middle. The inertia about it is that of an even box about its middle.",
                         "assumed"),
             number_spec("weight", Quantity::mass, "0 g", non_negative,
                         "Mass of a weight put into the box, beside the box's own.", "free"),
             vector_spec(3, "weight_place", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                         "Place of the weight, a point, from the box's middle.", "free")}),
      shape("capsule", "A cylinder along Z with half a ball at either end.",
            {number_spec("radius", Quantity::length, "20 mm", positive, "Radius.", "assumed"),
             number_spec("length", Quantity::length, "60 mm", positive, "Length of the straight part.", "assumed")}),
      shape("cylinder", "A cylinder along Z.",
            {number_spec("radius", Quantity::length, "20 mm", positive, "Radius.", "assumed"),
             number_spec("length", Quantity::length, "60 mm", positive, "Length.", "assumed"),
             number_spec("bore", Quantity::length, "0 mm", non_negative,
                         "Radius of a hole along the axis, below `radius`. It changes the inertia alone: a glass.", "free"),
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
