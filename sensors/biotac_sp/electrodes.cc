#include "sensors/biotac_sp/electrodes.h"

namespace slipbench::biotac_sp {
namespace {

constexpr double mm = 1e-3;

}  // namespace

// Positions of the maker's drawing, as published with the BioTac SP recordings of yayaneath/BioTacSP-DoS and in bsadr/biotac.
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

// Of the recordings in yayaneath/BioTacSP-DoS: 97th percentile over 111 recordings of the highest mean over 0.2 s. All of them are in
// contact, so the true readings at rest may be a few counts higher.
const std::array<double, electrodes>& rest_readings() {
  static constexpr std::array<double, electrodes> readings{3590, 3712, 3648, 3690, 3555, 3647, 3725, 3582,
                                                           3583, 3578, 3636, 3725, 3693, 3566, 3531, 3683,
                                                           3583, 3554, 3066, 2986, 3718, 3693, 3692, 3561};
  return readings;
}

// Of the same: the 44 recordings of a touch have 4.1 counts in the median.
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

}  // namespace slipbench::biotac_sp
