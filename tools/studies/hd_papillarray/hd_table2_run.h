// What Table II simulates: grasps under two protocols, with boxes, surfaces and loops of detector and controller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tools/studies/grid.h"

namespace slipbench::reproduce {

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
