// How large the disturbances of a PapillArray's electronics are.
#pragma once

#include <cstddef>
#include <vector>

#include "sensors/electronics/electronics.h"

namespace slipbench::papillarray {

inline constexpr std::size_t pillars = 9;
inline constexpr std::size_t axes = 3;
inline constexpr std::size_t channel_size = pillars * axes;

// Stiffness of one pillar [N/m].
struct PillarStiffness {
  double normal;
  double tangential;
};
inline constexpr PillarStiffness gripper_stiffness{7.1e3, 3.9e3};
inline constexpr PillarStiffness hexapod_stiffness{1.2e3, 0.65e3};

// The measured figures for the values force {9,3} [N], displacement {9,3} [m] at `rate` [Hz]. The force of an axis and the
// displacement of that axis share a source. The force figures were measured at the gripper's stiffness and go in proportion to
// it.
SignalModel signal_model(const PillarStiffness& stiffness, double rate);

// The parts of its electronics, with the figures that were measured on a PapillArray.
std::vector<Entry> electronics_parts();

}  // namespace slipbench::papillarray
