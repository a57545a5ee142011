// A biotac_sp with default or changed parameters, and contacts for it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "sensors/biotac_sp/biotac_sp.h"
#include "sim/api/sensor.h"
#include "sim/contact/contact_labels.h"
#include "sim/contact/field.h"

namespace slipbench::biotac_sp_test {

inline constexpr double pi = std::numbers::pi;
inline constexpr std::size_t electrodes = 24, pdc = 24, pac = 25;
// Counts at rest (SENSORS: rest proxy of the public recordings).
inline constexpr std::array<double, electrodes> rest{3590, 3712, 3648, 3690, 3555, 3647, 3725, 3582, 3583, 3578, 3636, 3725,
                                                     3693, 3566, 3531, 3683, 3583, 3554, 3066, 2986, 3718, 3693, 3692, 3561};

using Changes = std::vector<std::pair<std::string, Parameters::Value>>;

inline std::unique_ptr<Sensor> make(const Changes& changes = {}, const std::vector<std::string>& electronics = {},
                                    std::uint64_t trial = 0, const std::string& name = "finger") {
  Parameters parameters = defaults_of(biotac_sp_sensor().about.parameters);
  for (const auto& [key, value] : changes) parameters.set(key, value);
  std::vector<Named> parts;
  for (const Entry& entry : biotac_sp_sensor().electronics) {
    for (const std::string& part : electronics) {
      if (part == entry.name || part == "typical") parts.push_back({entry.name, defaults_of(entry.parameters)});
    }
  }
  return biotac_sp_sensor().create(parameters, parts, 7, trial, name);
}

// All electrodes in every reading, without the scan.
inline Changes at_once() { return {{"scan", std::string("ideal")}, {"cycle_rate", 100.0}}; }
inline Changes at_once_and(const Changes& more) {
  Changes changes = at_once();
  changes.insert(changes.end(), more.begin(), more.end());
  return changes;
}

// A contact in which element i of `sensor` has the depth `depth(element)` and no drag.
template <class Depth>
ContactFrame dented(const Sensor& sensor, Depth&& depth) {
  const auto& elements = sensor.layout().elements;
  ContactFrame frame;
  frame.element_depth.setZero(static_cast<Eigen::Index>(elements.size()));
  frame.element_shear.setZero(static_cast<Eigen::Index>(elements.size()), 3);
  for (std::size_t i = 0; i < elements.size(); ++i) frame.element_depth[static_cast<Eigen::Index>(i)] = depth(elements[i]);
  frame.state = PadState::non_slip;
  return frame;
}
inline ContactFrame evenly_dented(const Sensor& sensor, double depth) {
  return dented(sensor, [&](const Element&) { return depth; });
}

// The pose of the pad that brings its point with outward normal `outward` (in P) straight down,
// `depth` below the plane z = 0, for a skin of these radii. The support point of an ellipsoid about
// its middle is R^2 n/|R n|.
inline Pose pressed(const Eigen::Vector3d& outward, double depth, const Eigen::Vector3d& radii) {
  const Eigen::Vector3d in_p(radii.x(), radii.z(), radii.y()), n = outward.normalized();
  const Eigen::Vector3d scaled = in_p.cwiseProduct(n);
  const Eigen::Vector3d lowest = in_p.cwiseProduct(scaled) / scaled.norm() + Eigen::Vector3d(0.0, 0.0, radii.y());
  Pose pose;
  pose.rotation = element_frame(n).transpose();  // takes n to -Z
  pose.position = -(pose.rotation * lowest);
  pose.position.z() -= depth;
  return pose;
}

inline const Eigen::Vector3d radii{13.85e-3, 10.1e-3, 9.85e-3};

}  // namespace slipbench::biotac_sp_test
