// What the tables of the paper are made of: the offline evaluation, a grasp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/base/record/json.h"
#include "tools/base/statistics/descriptive.h"

namespace slipbench::reproduce {

// The paper's estimate of the forces of one grasp.
struct EstimatedForces {
  double most = 0.0;   // N, largest sum of all pillars' normal forces up to 10 N, over all rows; NaN: there is none
  double ideal = 0.0;  // N; NaN: no row counts as incipient slip
  [[nodiscard]] double ratio() const { return most / ideal; }
};

// As getGripForce.m of the published repository does it (JT2106/Hyperdimensional-computing-tactile-sensing). Rows are every
// `stride`-th sample, the first of them number stride - 1; those with a value that is not finite are left out. Windows of four
// rows, one after the other, count when at least three rows are incipient or gross and one is incipient; one that does not count
// is tried again a row later, and none begins at the fourth row from the end. Of the incipient rows in those that count, ideal =
// min of sum f_t / mean(f_t/f_n), where zeros and ratios from 1 on do not enter the mean. `force`: [T,N,3] N, z normal.
// `classes`: [T] PadState.
EstimatedForces estimated_forces(std::span<const float> force, std::span<const std::uint8_t> classes, std::size_t stride);

// How far the box slipped, as two markers of a motion capture system see it (getSlides.m of that repository).
struct MarkerSlip {
  double along = 0.0;  // m, |way of the box's marker over that of the gripper's along Z|
  double spin = 0.0;   // rad, |change of the angle between Z and the line from the gripper's marker to the box's|
};

// Means over 51 samples up to number `lift`, and over the last 101. `arm`, `box`: [T,7] poses, at least lift + 1 and 101 of them.
// The box's marker is taken to be in its middle, the gripper's where those of the published recordings are: see marker_line.
MarkerSlip marker_slip(std::span<const float> arm, std::span<const float> box, std::size_t lift);

// From the gripper's marker to the box's in X, Y, Z before the lift [m]: mean of the 30 published recordings of light boxes.
// Which way their X and Y lie to the gripper is not said.
inline constexpr double marker_line[3] = {3.3e-3, -1.7e-3, -135.4e-3};

// Values of one quantity; NaN are left out.
struct Spread {
  std::size_t n = 0;
  double median = 0.0;  // NaN of none
  Interval interval;    // of the median, 95 %, whatever the distribution (order statistics); NaN of fewer than six
  MeanSd mean_sd;
};
Spread spread(std::vector<double> values);

inline constexpr const char* hexapod_scene = "scenes/papillarray/hexapod.yaml";  // the published protocol

}  // namespace slipbench::reproduce
