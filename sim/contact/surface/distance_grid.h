// The signed distance of a closed surface, computed once at the nodes of a regular grid, for shapes
// whose distance is expensive.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

#include <Eigen/Core>

#include "sim/contact/surface/surface_point.h"

namespace slipbench {

// A uniform tricubic B-spline through samples of a distance. Its coefficients along each axis are
//   c = (1 - D/6 + D^2/36) f,   D f_i = f_(i-1) - 2 f_i + f_(i+1)
// the start of the series of (1 + D/6)^-1, which interpolates (de Boor, A Practical Guide to
// Splines, ch. XII). So it is local: a kink of the distance acts up to 4 cells away along each
// axis. Cubics are reproduced exactly; on a smooth surface the error of the distance is of fourth
// order in the cell and that of the normal, its gradient, of third order; the normal and its slope
// are continuous. Inside an edge or a corner, where the distance has a kink, the faces are blended
// within 4 cells, and so are two sides that are less than about 8 cells apart.
//
// Copies share the samples, which never change: any number of threads may read them.
class DistanceGrid {
 public:
  struct Samples;
  static constexpr std::size_t max_nodes = std::size_t{1} << 23;  // 64 MiB

  // Samples `distance`, the signed distance [m] to a closed surface within the box from `low` to
  // `high` [m], in cells of the edge length `cell` [m]; the grid extends beyond the box by at least
  // 3 cells. Calls `distance` once per node, up to 6 cells outside the box. Throws
  // std::invalid_argument unless the box and the cell are positive and finite, the grid has at most
  // max_nodes nodes, and every sample is finite and no smaller than its distance to the
  // box; otherwise the surface would not lie within the box.
  DistanceGrid(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& low,
               const Eigen::Vector3d& high, double cell);

  // Returns the cell [m] for which the grid of a box with the edges `extent` [m] has `nodes` nodes,
  // or a few less. `nodes` must be above 13^3, the number for an empty box.
  [[nodiscard]] static double cell_for(const Eigen::Vector3d& extent, std::size_t nodes);

  // As in surface.h, for one smooth surface: the nearest point is met. Outside the grid the gap is
  // that of the box around the surface: a lower bound of the distance, and positive. Where the
  // gradient vanishes (the middle of a ball) there is no nearest point.
  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az) const;

  // The cell [m], and the number of stored nodes, 8 bytes each.
  [[nodiscard]] double cell() const;
  [[nodiscard]] std::size_t nodes() const;

  // The samples that copies share; the constructor below makes the same grid from them.
  [[nodiscard]] const std::shared_ptr<const Samples>& samples() const { return samples_; }
  explicit DistanceGrid(std::shared_ptr<const Samples> samples) : samples_(std::move(samples)) {}

 private:
  [[nodiscard]] static SurfacePoint outside(const Samples& grid, double x, double y, double z);

  std::shared_ptr<const Samples> samples_;
};

}  // namespace slipbench
