#include "sim/simulation/bodies.h"

#include <string>
#include <utility>

namespace slipbench {
namespace {

ParameterSpec vector_of_three(std::string name, Quantity quantity, std::string default_text, Range range, std::string doc,
                              std::string source) {
  return {std::move(name), ParameterType::vector, quantity, std::move(default_text), range, {}, 3,
          std::move(doc),  std::move(source)};
}

ParameterSpec length(std::string name, std::string default_text, std::string doc) {
  return {std::move(name), ParameterType::number, Quantity::length, std::move(default_text), positive, {}, 1, std::move(doc),
          "assumed"};
}

std::vector<ParameterSpec> place() {
  return {vector_of_three("position", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                          "where its middle is at the start, in the world", "free"),
          vector_of_three("rotation", Quantity::angle, "[0 deg, 0 deg, 0 deg]", any_value,
                          "how it is turned at the start: about the world's X axis, then Y, then Z", "free"),
          {"friction",
           ParameterType::number,
           Quantity::none,
           "0.5",
           {0.0, 100.0},
           {},
           1,
           "coefficient of MuJoCo's own contact with other bodies; of two that meet the larger counts. Pads do not use it",
           "assumed"}};
}

Entry shape(std::string name, std::string summary, std::vector<ParameterSpec> sizes) {
  Entry entry{std::move(name), std::move(summary), "", "", std::move(sizes)};
  for (ParameterSpec& spec : place()) entry.parameters.push_back(std::move(spec));
  entry.parameters.push_back(
      {"mass", ParameterType::number, Quantity::mass, "100 g", positive, {}, 1, "mass, spread evenly", "assumed"});
  entry.parameters.push_back({"free",
                              ParameterType::flag,
                              Quantity::none,
                              "true",
                              any_value,
                              {},
                              1,
                              "whether forces move it; else it stands still",
                              "free"});
  entry.parameters.push_back(vector_of_three("velocity", Quantity::speed, "[0 m/s, 0 m/s, 0 m/s]", any_value,
                                             "of its middle at the start; a body that is not free has none", "free"));
  return entry;
}

}  // namespace

const std::vector<Entry>& body_catalogue() {
  static const std::vector<Entry> shapes{
      shape("box", "A box.",
            {vector_of_three("size", Quantity::length, "[40 mm, 40 mm, 60 mm]", positive, "extent along X, Y, Z", "assumed"),
             vector_of_three("centre_of_mass", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                             "from its middle; about it the box turns as an even one about its middle", "assumed"),
             {"weight",
              ParameterType::number,
              Quantity::mass,
              "0 g",
              non_negative,
              {},
              1,
              "mass of a weight put into the box, beside its own",
              "free"},
             vector_of_three("weight_place", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                             "where the weight is, from the box's middle: a point", "free")}),
      shape("capsule", "A cylinder along Z with half a ball at either end.",
            {length("radius", "20 mm", "radius"), length("length", "60 mm", "length of the straight part")}),
      shape("cylinder", "A cylinder along Z.",
            {length("radius", "20 mm", "radius"),
             length("length", "60 mm", "length"),
             {"bore",
              ParameterType::number,
              Quantity::length,
              "0 mm",
              non_negative,
              {},
              1,
              "radius of a hole along its axis, of which only its inertia knows: a glass; below the radius",
              "free"},
             vector_of_three("centre_of_mass", Quantity::length, "[0 mm, 0 mm, 0 mm]", any_value,
                             "from its middle; about it the cylinder turns as an even one about its middle", "assumed")}),
      shape("ellipsoid", "An ellipsoid.",
            {vector_of_three("size", Quantity::length, "[40 mm, 40 mm, 60 mm]", positive, "extent along X, Y, Z", "assumed")}),
      {"plane", "An endless plane, the world's X and Y at the start; it stands still.", "", "", place()},
      shape("sphere", "A ball.", {length("radius", "30 mm", "radius")}),
  };
  return shapes;
}

}  // namespace slipbench
