// What is known of each of the 24 electrodes of a BioTac SP. Electrode E1 has the index 0.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace slipbench::biotac_sp {

inline constexpr std::size_t electrodes = 24;

// Middle of each electrode on the rigid core [m], in the device's own axes: x along the finger, y away from the object, z across.
const std::array<Eigen::Vector3d, electrodes>& electrode_places();

// Reading of each that nothing touches [counts].
const std::array<double, electrodes>& rest_readings();

// Standard deviation of the noise of each against the mean of all.
const std::array<double, electrodes>& relative_noise();

// A position in the device's own axes in the pad frame P, whose origin is the skin's outermost point and whose +Z goes into the finger.
// `bulge`: how far the skin reaches outwards, along -y, from the device's origin [m].
inline Eigen::Vector3d in_pad_frame(const Eigen::Vector3d& place, double bulge) {
  return {place.x(), -place.z(), place.y() + bulge};
}

}  // namespace slipbench::biotac_sp
