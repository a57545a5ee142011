// The signed distance of a closed surface, computed once at the nodes of a regular grid: for shapes whose distance is dear.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include <Eigen/Core>

#include "sim/field/surface/surface_point.h"

namespace slipbench {

// A uniform tricubic B-spline through samples of a distance. Its coefficients along each axis are
//   c = (1 - D/6 + D^2/36) f,   D f_i = f_(i-1) - 2 f_i + f_(i+1)
// the start of the series of (1 + D/6)^-1, which interpolates (de Boor, A Practical Guide to Splines, ch. XII). So it is local: a
// kink of the distance is felt 4 cells away along each axis and no further. Cubics are reproduced exactly; on a smooth surface
// the distance is right to the fourth order of the cell and the normal, its gradient, to the third; the normal and its slope are
// continuous. Inside an edge or a corner, where the distance has a kink, the faces are blended into each other within 4 cells,
// and so are two sides that are less than about 8 cells apart.
//
// Copies share the samples, which never change: any number of threads may read them.
class DistanceGrid {
 public:
  struct Samples;
  static constexpr std::size_t max_nodes = std::size_t{1} << 23;  // 64 MiB

  // Samples `distance`, the signed distance [m] to a closed surface within the box from `low` to `high` [m], in cells of the edge
  // length `cell` [m]; the grid stands out beyond the box by at least 3 cells. Calls `distance` once a node, up to 6 cells
  // outside the box. Throws std::invalid_argument unless the box and the cell are positive and finite, the grid has at most
  // max_nodes nodes, and every sample is finite and no smaller than its distance to the box: else the surface would not lie
  // within it.
  DistanceGrid(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& low,
               const Eigen::Vector3d& high, double cell);

  // The cell [m] with which the grid of a box of the edges `extent` [m] has `nodes` nodes, or a few less. `nodes` must be above
  // 13^3, those of an empty box.
  [[nodiscard]] static double cell_for(const Eigen::Vector3d& extent, std::size_t nodes);

  // As in surface.h, for one smooth surface: the nearest point is the one met. Outside the grid the gap is that of the box around
  // the surface: a lower bound of the distance, and positive. Where the gradient vanishes (the middle of a ball) there is no
  // nearest point.
  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const;

  // The cell [m], and the number of nodes that are kept, 8 bytes each.
  [[nodiscard]] double cell() const;
  [[nodiscard]] std::size_t nodes() const;

  // What copies share, for whoever wants to share it further: the same grid again.
  [[nodiscard]] const std::shared_ptr<const Samples>& samples() const { return samples_; }
  explicit DistanceGrid(std::shared_ptr<const Samples> samples) : samples_(std::move(samples)) {}

 private:
  [[nodiscard]] static SurfacePoint outside(const Samples& grid, double x, double y, double z);

  std::shared_ptr<const Samples> samples_;
};

}  // namespace slipbench
