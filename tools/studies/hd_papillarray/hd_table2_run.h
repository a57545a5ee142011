// What a trial of Table II comes to, and what many of them come to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tools/base/statistics/binomial.h"
#include "tools/base/statistics/descriptive.h"
#include "tools/studies/grid.h"

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

// What Table II simulates: grasps under two protocols, with boxes, surfaces and loops of detector and controller.
inline constexpr const char* lift_scene = "scenes/grasp/lift.yaml";
// Rows of the published log: four of them are 0.6 s in the paper, 15 frames of its 100 Hz each.
inline constexpr std::size_t row_stride = 15;

// One of the values that an axis of the table takes.
struct GraspChoice {
  std::string name;
  std::string text;  // as the table shows it
  std::vector<Override> overrides;
};
const std::vector<GraspChoice>& grasp_surfaces();

struct GraspCell {
  GraspChoice protocol, box, surface, loop;
  bool usable = true;  // what the loop needs is there

  // With `draws` trials.
  [[nodiscard]] GridCell grid(std::size_t draws = 1) const;
};

// What a trial came to. NaN where the box was dropped, or the figure does not exist.
struct GraspFigures {
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  bool dropped = false;
  double slip = nan, rotation = nan;            // m, rad
  double marker_slip = nan, marker_spin = nan;  // m, rad
  double true_ratio = nan;
  double estimated_ratio = nan, frame_ratio = nan;  // by the paper's script, a row a window or a frame
  double counts = nan;                              // by which the gripper closed after the lift had begun
};
using Grasps = std::vector<GraspFigures>;

// The cells that options.only asks for, in the order of the table: protocol, box, surface, loop. Throws InputError for a name
// that no choice has.
std::vector<GraspCell> grasp_cells(const ReproduceOptions& options);

// The trials of each cell; of one that is not usable none. Throws InputError and Interrupted as run_grid does.
std::vector<Grasps> run_grasps(const std::vector<GraspCell>& cells, std::size_t trials, const ReproduceOptions& options);

}  // namespace slipbench::reproduce
