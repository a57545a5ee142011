#include "sensors/biotac_sp/skin.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "sim/core/math.h"
#include "sim/core/quantity.h"
#include "sim/core/readable_quantity.h"

namespace slipbench::biotac_sp {
namespace {

constexpr double mm = 1e-3;

// Eigen's exponential calls the C library for the remainder of its vectors, so results would depend
// on the platform.
Eigen::ArrayXXd exponential(const Eigen::ArrayXXd& x) {
  return x.unaryExpr([](double value) { return math::exp(value); });
}

}  // namespace

// Positions from the maker's drawing, as published with the BioTac SP recordings of
// yayaneath/BioTacSP-DoS and in bsadr/biotac.
const std::array<Eigen::Vector3d, electrodes>& electrode_places() {
  static const std::array<Eigen::Vector3d, electrodes> places{{
      {9.8154 * mm, -2.7677 * mm, 3.9845 * mm},   {8.1012 * mm, -5.2081 * mm, 3.0659 * mm},
      {2.2193 * mm, -3.2655 * mm, 7.1623 * mm},   {2.1309 * mm, -5.9925 * mm, 5.1198 * mm},
      {-0.4731 * mm, -7.6230 * mm, 2.4109 * mm},  {-2.3339 * mm, -3.0591 * mm, 7.2379 * mm},
      {-3.4712 * mm, -6.0338 * mm, 4.7529 * mm},  {-5.6757 * mm, -6.8751 * mm, 1.8170 * mm},
      {-8.1471 * mm, -5.0673 * mm, 3.2454 * mm},  {-10.0821 * mm, -2.5411 * mm, 3.8498 * mm},
      {9.8154 * mm, -2.7677 * mm, -3.9845 * mm},  {8.1012 * mm, -5.2081 * mm, -3.0659 * mm},
      {2.2193 * mm, -3.2655 * mm, -7.1623 * mm},  {2.1309 * mm, -5.9925 * mm, -5.1198 * mm},
      {-0.4731 * mm, -7.6230 * mm, -2.4109 * mm}, {-2.3339 * mm, -3.0591 * mm, -7.2379 * mm},
      {-3.4712 * mm, -6.0338 * mm, -4.7529 * mm}, {-5.6757 * mm, -6.8751 * mm, -1.8170 * mm},
      {-8.1471 * mm, -5.0673 * mm, -3.2454 * mm}, {-10.0821 * mm, -2.5411 * mm, -3.8498 * mm},
      {6.5723 * mm, -6.4094 * mm, 0.0},           {4.3219 * mm, -6.9705 * mm, 1.8519 * mm},
      {4.3219 * mm, -6.9705 * mm, -1.8519 * mm},  {1.9133 * mm, -7.5710 * mm, 0.0},
  }};
  return places;
}

// Published with TAMS-Group/tams_biotac and in several drivers, as x along the finger to its tip, y
// across, z outwards below 0.
const std::array<Eigen::Vector3d, electrodes_19>& electrode_places_19() {
  static const std::array<Eigen::Vector3d, electrodes_19> places = [] {
    constexpr double middle = -7.0;
    constexpr std::array<double, electrodes_19> x{0.993, -2.7, -6.2, -8.0, -10.5, -13.4, 4.763, 3.031, 3.031, 1.299,
                                                  0.993, -2.7, -6.2, -8.0, -10.5, -13.4, -2.8,  -9.8,  -13.6};
    constexpr std::array<double, electrodes_19> y{-4.855, -3.513, -3.513, -4.956, -3.513, -4.956, 0.0, -1.95, 1.95, 0.0,
                                                  4.855,  3.513,  3.513,  4.956,  3.513,  4.956,  0.0, 0.0,   0.0};
    constexpr std::array<double, electrodes_19> z{-1.116, -3.67, -3.67, -1.116, -3.67, -1.116, -2.33, -3.33, -3.33, -4.33,
                                                  -1.116, -3.67, -3.67, -1.116, -3.67, -1.116, -5.08, -5.08, -5.08};
    std::array<Eigen::Vector3d, electrodes_19> all;
    for (std::size_t e = 0; e < electrodes_19; ++e) all[e] = Eigen::Vector3d((x[e] - middle) * mm, z[e] * mm, y[e] * mm);
    return all;
  }();
  return places;
}

// From the recordings in yayaneath/BioTacSP-DoS: 97th percentile over 111 recordings of the highest
// mean over 0.2 s. All of them are in contact, so the true readings at rest may be a few counts
// higher.
const std::array<double, electrodes>& rest_readings() {
  static constexpr std::array<double, electrodes> readings{3590, 3712, 3648, 3690, 3555, 3647, 3725, 3582,
                                                           3583, 3578, 3636, 3725, 3693, 3566, 3531, 3683,
                                                           3583, 3554, 3066, 2986, 3718, 3693, 3692, 3561};
  return readings;
}

// From the same recordings: the median over the 44 recordings of a touch is 4.1 counts.
const std::array<double, electrodes>& relative_noise() {
  static constexpr std::array<double, electrodes> counts{3.6, 4.6, 3.5, 4.2, 4.0, 4.0, 3.7, 4.7, 3.8, 4.3, 4.0, 4.9,
                                                         3.9, 4.1, 4.2, 4.4, 4.0, 4.5, 3.6, 3.4, 3.5, 4.7, 4.1, 4.4};
  static const std::array<double, electrodes> relative = [] {
    std::array<double, electrodes> result = counts;
    for (double& sd : result) sd /= 4.1;
    return result;
  }();
  return relative;
}

Skin make_skin(const SkinFigures& figures, const std::string& sensor, std::span<const Eigen::Vector3d> places) {
  const Eigen::Vector3d& radii = figures.radii;
  Skin skin;
  for (const Eigen::Vector3d& place : places) {
    skin.above.push_back(in_pad_frame(place / place.cwiseQuotient(radii).norm(), radii.y()));
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
    const Eigen::Vector3d u(around * math::cos(angle), height, around * math::sin(angle));
    const Eigen::Vector3d slope = u.cwiseQuotient(radii);
    Point& point = points[k];
    point.element.tip = in_pad_frame(u.cwiseProduct(radii), radii.y());
    point.element.axis = in_pad_frame(slope.normalized(), 0.0).normalized();
    point.area = 2.0 * std::numbers::pi / count * radii.prod() * slope.norm();
    whole += point.area;
    double nearest = INFINITY;
    for (std::size_t e = 0; e < places.size(); ++e) {
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
  for (std::size_t e = 0, first = 0; e < places.size(); ++e) {
    const auto own = static_cast<std::size_t>(std::ranges::count(points, e, &Point::electrode));
    if (own == 0) {
      const auto length = [](double value) { return readable_quantity(value, Quantity::length); };
      throw SceneValueError(sensor + ".radii",
                            "[" + length(radii.x()) + ", " + length(radii.y()) + ", " + length(radii.z()) +
                                "] leaves electrode E" + std::to_string(e + 1) + " without any of the " +
                                counted(points.size(), "element") + " of the skin; use radii near the device's, " +
                                (places.size() == electrodes ? own_radii : own_radii_19) + ", or more elements");
    }
    skin.layout.units.push_back({first, own});
    first += own;
  }
  skin.layout.element_truth = true;
  skin.layout.unit_truth = UnitTruth::none;
  return skin;
}

Dents::Dents(const Skin& skin, const Kernel& kernel, const std::string& sensor) {
  const std::vector<Element>& elements = skin.layout.elements;
  const auto n = static_cast<Eigen::Index>(elements.size());
  const Eigen::Map<const Eigen::ArrayXd> area(skin.area.data(), n);
  const auto columns = static_cast<Eigen::Index>(skin.above.size());
  Eigen::ArrayXXd distance(n, columns);
  for (Eigen::Index e = 0; e < columns; ++e) {
    for (Eigen::Index i = 0; i < n; ++i) {
      distance(i, e) = (elements[static_cast<std::size_t>(i)].tip - skin.above[static_cast<std::size_t>(e)]).norm();
    }
  }
  // Share of the response to an element right above the electrode. Below it the sum over the skin
  // is rounding error of exp, which scaling would not turn into a kernel.
  constexpr double nothing = 1e-12;
  const auto scaled = [&](const Eigen::ArrayXXd& felt, double share, const char* parameter, double reach) {
    const Eigen::ArrayXXd weighted = felt.colwise() * area;
    if (felt.colwise().maxCoeff().minCoeff() < nothing) {
      throw SceneValueError(
          sensor + "." + parameter,
          readable_quantity(reach, Quantity::length) +
              " is so short that an electrode does not feel its nearest element; use at least about the distance of two elements, " +
              readable_quantity(std::round(1e4 * std::sqrt(area.mean())) / 1e4, Quantity::length));
    }
    return Eigen::ArrayXXd(share / weighted.colwise().sum().maxCoeff() * weighted);
  };
  const Eigen::ArrayXXd near =
      scaled(exponential(-0.5 * (distance / kernel.near).square()), 1.0 - kernel.far_share, "near", kernel.near);
  const Eigen::ArrayXXd far = scaled(exponential(-distance / kernel.far), kernel.far_share, "far", kernel.far);
  depth_ = (near + far).colwise() - kernel.swell / area.sum() * area;
  if (kernel.stretch == 0.0) return;

  // dG/dr along the skin's tangent at the element, away from the electrode. Right above an
  // electrode the far kernel falls equally fast in every direction, so the gradient has no
  // direction and the term is left out.
  const Eigen::ArrayXXd slope = -(near * distance / (kernel.near * kernel.near) + far / kernel.far);
  drag_.setZero(3 * n, columns);
  for (Eigen::Index e = 0; e < columns; ++e) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (distance(i, e) == 0.0) continue;
      const Element& element = elements[static_cast<std::size_t>(i)];
      const Eigen::Vector3d away = (element.tip - skin.above[static_cast<std::size_t>(e)]) / distance(i, e);
      const Eigen::Vector3d along = away - element.axis * element.axis.dot(away);
      for (Eigen::Index k = 0; k < 3; ++k) drag_(k * n + i, e) = kernel.stretch * slope(i, e) * along[k];
    }
  }
}

}  // namespace slipbench::biotac_sp
