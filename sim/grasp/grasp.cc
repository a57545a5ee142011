#include "sim/grasp/grasp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "sim/core/random.h"

namespace slipbench {
namespace {

void add_scatter(Grasp& grasp, const Parameters& scatter, double period, std::uint64_t seed, std::uint64_t trial) {
  const auto stream = [&](const char* name) { return RandomStream(seed, trial, std::string("scatter.") + name); };
  RandomStream position = stream("position"), centre = stream("centre_of_mass");
  for (int k = 0; k < 3; ++k) {
    grasp.box_position[k] += scatter.vector("position")[static_cast<std::size_t>(k)] * position.normal();
    grasp.centre_of_mass[k] += scatter.number("centre_of_mass") * centre.normal();
  }
  grasp.yaw += scatter.number("yaw") * stream("yaw").normal();
  grasp.pitch += scatter.number("pitch") * stream("pitch").normal();
  grasp.box_size.x() += scatter.number("width") * stream("width").uniform();
  grasp.friction_scale *= std::exp(scatter.number("friction") * stream("friction").normal());
  if (scatter.flag("phase")) grasp.phase += period * stream("phase").uniform();
}

}  // namespace

Grasp draw_grasp(const GraspScene& scene, std::uint64_t seed, std::uint64_t trial) {
  const Parameters &grip = scene.grip, &box = scene.box;
  Grasp grasp;
  grasp.box_size = Eigen::Vector3d::Map(box.vector("size").data());
  grasp.box_position << box.vector("position")[0], box.vector("position")[1], 0.5 * grasp.box_size.z() - grip.number("height");
  grasp.centre_of_mass = Eigen::Vector3d::Map(box.vector("centre_of_mass").data());
  grasp.yaw = grip.number("yaw");
  grasp.pitch = grip.number("pitch");
  grasp.phase = grip.number("phase");
  if (scene.scatter) add_scatter(grasp, *scene.scatter, grip.number("period"), seed, trial);

  grasp.opening = grasp.box_size.x() + 2.0 * (grip.number("clearance") + std::abs(grasp.box_position.x()));
  const double widest = static_cast<double>(grip.integer("closed_at") - grip.integer("open_at")) * grip.number("count");
  if (widest <= 0.0) {
    throw SceneValueError("grip.open_at", fmt::format("{} is not open: the fingers are closed at {}; allowed: less than that",
                                                      grip.integer("open_at"), grip.integer("closed_at")));
  }
  if (grasp.opening > widest) {
    throw SceneValueError(
        "box.size",
        fmt::format("a box of {} with its clearance does not fit between the fingers; allowed: {} in all",
                    format_quantity(grasp.box_size.x(), Quantity::length), format_quantity(widest, Quantity::length)));
  }
  const Eigen::Vector3d beyond = grasp.box_position.cwiseAbs() - 0.5 * grasp.box_size;
  if (beyond.y() > 0.0 || beyond.z() > 0.0) {
    throw SceneValueError("box",
                          "the middle of the pads is beside the box; allowed: grip.height and box.position such that it is not");
  }
  return grasp;
}

PadLayout second_pad(const Parameters& grip, const PadLayout& sensor) {
  constexpr int columns = 4, rows = 6;
  if (grip.choice("second_pad") == "same") return sensor;
  const std::vector<double>&size = grip.vector("pad_size"), &stiffness = grip.vector("pad_stiffness");
  PadLayout layout;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      Element element;
      element.tip = {size[0] * ((column + 0.5) / columns - 0.5), size[1] * ((row + 0.5) / rows - 0.5), 0.0};
      element.k_normal = stiffness[0] / (columns * rows);
      element.k_tangential = stiffness[1] / (columns * rows);
      layout.units.push_back({layout.elements.size(), 1});
      layout.elements.push_back(element);
    }
  }
  return layout;
}

PadLayout box_corners(const Parameters& box, const Eigen::Vector3d& box_size) {
  constexpr double standing = 4.0;  // corners
  PadLayout layout;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d side((corner & 1) != 0 ? 1.0 : -1.0, (corner & 2) != 0 ? 1.0 : -1.0, (corner & 4) != 0 ? 1.0 : -1.0);
    Element element;
    element.tip = 0.5 * side.cwiseProduct(box_size);
    element.axis = side.normalized();
    element.k_normal = element.k_tangential = box.number("table_stiffness") / standing;
    layout.units.push_back({layout.elements.size(), 1});
    layout.elements.push_back(element);
  }
  return layout;
}

double ideal_grip_force(const Scene& scene, double friction_scale, double gravity) {
  const double mu = scene.friction.static_coefficient * friction_scale;
  const double mass = scene.grasp->box.number("mass") + scene.grasp->box.number("weight");
  return mu > 0.0 ? 0.5 * mass * gravity / mu : std::numeric_limits<double>::infinity();
}

}  // namespace slipbench
