#include "sensors/biotac_sp/skin.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench::biotac_sp {

Skin make_skin(const SkinFigures& figures, const std::string& sensor) {
  const Eigen::Vector3d& radii = figures.radii;
  Skin skin;
  for (std::size_t e = 0; e < electrodes; ++e) {
    const Eigen::Vector3d& place = electrode_places()[e];
    skin.above[e] = in_pad_frame(place / place.cwiseQuotient(radii).norm(), radii.y());
  }

  struct Point {
    Element element;
    double area;
    std::size_t electrode;
  };
  std::vector<Point> points(figures.elements);
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0)), count = static_cast<double>(figures.elements);
  double whole = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double height = (static_cast<double>(k) + 0.5) / count - 1.0, around = std::sqrt(1.0 - height * height);
    const double angle = golden_angle * static_cast<double>(k);
    const Eigen::Vector3d u(around * std::cos(angle), height, around * std::sin(angle));
    const Eigen::Vector3d slope = u.cwiseQuotient(radii);
    Point& point = points[k];
    point.element.tip = in_pad_frame(u.cwiseProduct(radii), radii.y());
    point.element.axis = in_pad_frame(slope.normalized(), 0.0).normalized();
    point.area = 2.0 * std::numbers::pi / count * radii.prod() * slope.norm();
    whole += point.area;
    double nearest = INFINITY;
    for (std::size_t e = 0; e < electrodes; ++e) {
      const double distance = (point.element.tip - skin.above[e]).squaredNorm();
      if (distance < nearest) {
        nearest = distance;
        point.electrode = e;
      }
    }
  }

  std::ranges::stable_sort(points, {}, &Point::electrode);
  for (Point& point : points) {
    point.element.k_normal = figures.k_normal * point.area / whole;
    point.element.k_tangential = figures.shear * point.element.k_normal;
    skin.layout.elements.push_back(point.element);
    skin.area.push_back(point.area);
  }
  for (std::size_t e = 0, first = 0; e < electrodes; ++e) {
    const auto own = static_cast<std::size_t>(std::ranges::count(points, e, &Point::electrode));
    if (own == 0) {
      const auto length = [](double value) { return format_quantity(value, Quantity::length); };
      throw SceneValueError(sensor + ".radii", "[" + length(radii.x()) + ", " + length(radii.y()) + ", " + length(radii.z()) +
                                                   "] leaves electrode E" + std::to_string(e + 1) + " without one of the " +
                                                   std::to_string(points.size()) +
                                                   " elements of the skin; allowed: radii near the device's own, [13.85 mm, " +
                                                   "10.1 mm, 9.85 mm], or more elements");
    }
    skin.layout.units.push_back({first, own});
    first += own;
  }
  skin.layout.element_truth = true;
  return skin;
}

}  // namespace slipbench::biotac_sp
