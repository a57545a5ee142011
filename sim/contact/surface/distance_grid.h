// The signed distance of a closed surface, computed once at the nodes of a regular grid, for shapes
// whose distance is expensive.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "sim/contact/surface/surface_point.h"

namespace slipbench {

// A uniform tricubic B-spline through samples of a distance. Its coefficients along each axis are
//   c = (1 - D/6 + D^2/36) f,   D f_i = f_(i-1) - 2 f_i + f_(i+1)
// the start of the series of (1 + D/6)^-1, which interpolates (de Boor, A Practical Guide to
// Splines, ch. XII). So it is local: a kink of the distance acts up to 4 cells away along each
// axis. Cubics are reproduced exactly; on a smooth surface the error of the distance is of fourth
// order in the cell and that of the normal, its gradient, of third order; the normal and its slope
// are continuous. At a kink of the distance (at an edge, in the middle of a wall or of a narrow gap)
// the spline blends the faces on both sides, and with them all within 4 cells.
//
// So a grid of a function that also knows the normal uses the spline only where no kink is within
// its reach. Elsewhere it calls the function: the distance is then exact, at several times the cost. A
// kink is between two neighbouring nodes if the normal turns by more than 20 degrees from one to the
// other: the nearest points are on different faces, or the surface curves with a radius below 3
// cells. Facets that turn by less approximate a curved surface; the spline rounds their edges by up
// to 0.06 cells. In between, over one cell, the two distances are blended, which makes the gap
// continuous.
//
// Copies share the samples, which never change: any number of threads may read them.
class DistanceGrid {
 public:
  struct Samples;
  // The signed distance of a point [m], and the outward unit normal at the nearest point: the
  // gradient of the distance.
  struct Nearest {
    double distance;
    Eigen::Vector3d normal;
    bool hidden = false;  // true if that point lies inside another shell of the surface
  };
  using FindNearest = std::function<Nearest(const Eigen::Vector3d&)>;
  // A crossing of a straight line with the surface, at the distance `way` along the line [m].
  // `leaves`: how often the line leaves the surface there minus how often it enters. `normal`:
  // outward.
  struct Crossing {
    double way;
    int leaves;
    Eigen::Vector3d normal;
  };
  // All crossings of the line through a point along a unit vector, in ascending order.
  using FindCrossings = std::function<std::vector<Crossing>(const Eigen::Vector3d& p, const Eigen::Vector3d& direction)>;
  static constexpr std::size_t max_nodes = std::size_t{1} << 23;  // 64 MiB

  // Samples `distance`, the signed distance [m] to a closed surface within the box from `low` to
  // `high` [m], in cells of the edge length `cell` [m]; the grid extends beyond the box by at least
  // 3 cells. Calls `distance` once per node, up to 6 cells outside the box. Throws
  // std::invalid_argument unless the box and the cell are positive and finite, the grid has at most
  // max_nodes nodes, and every sample is finite and no smaller than its distance to the
  // box; otherwise the surface would not lie within the box.
  DistanceGrid(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& low,
               const Eigen::Vector3d& high, double cell);
  // The same for a function that also returns normals. `on_surface`: points of the surface, no farther
  // apart than a cell, which show details too small for the nodes. `near_kinks`: the same function,
  // which the grid keeps and calls beside kinks; it and `crossings` must be thread-safe.
  DistanceGrid(const FindNearest& nearest, FindNearest near_kinks, FindCrossings crossings,
               std::span<const Eigen::Vector3d> on_surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double cell);

  // Returns the cell [m] for which the grid of a box with the edges `extent` [m] has `nodes` nodes,
  // or a few less. `nodes` must be above 13^3, the number for an empty box.
  [[nodiscard]] static double cell_for(const Eigen::Vector3d& extent, std::size_t nodes);

  // As in surface.h. The nearest point is met, unless the tip is inside and the surface there looks
  // away from the element, is hidden, or is steep to the axis with another side in the way: then the
  // element meets the face that it entered, if the grid knows crossings, with `faces` = `entered`.
  // Outside the grid the gap is that of the box around the surface: a lower bound of the distance,
  // and positive. Where the gradient vanishes (the middle of a ball) there is no nearest point.
  // `column`: as in surface.h; infinity: unknown, but the element is known to point the right way.
  [[nodiscard]] SurfacePoint at(double x, double y, double z, double ax, double ay, double az, double column = 0.0) const;
  static constexpr unsigned entered = 2;  // a bit of SurfacePoint::faces

  // Follows the line from p backwards along the unit vector `axis` to where it leaves the surface
  // (`back` [m], with the outward normal there), and forwards (`ahead` [m]). Nothing if p is not
  // inside or the grid does not know crossings.
  struct Entry {
    double back, ahead;
    Eigen::Vector3d normal;
  };
  [[nodiscard]] bool knows_crossings() const;
  [[nodiscard]] std::optional<Entry> entry(const Eigen::Vector3d& p, const Eigen::Vector3d& axis) const;
  // True if an element with the axis `axis` whose tip moved straight from `from` to `to` left the
  // surface through a side opposite to the one by which it entered. `pressed_on`: the normal of the
  // face that it pressed on at `from`; zero if it was outside.
  [[nodiscard]] bool passes_through(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& axis,
                                    const Eigen::Vector3d& pressed_on) const;

  // The cell [m], and the number of stored nodes, 8 bytes each.
  [[nodiscard]] double cell() const;
  [[nodiscard]] std::size_t nodes() const;
  // True if the distance at p is that of the function and not that of the spline.
  [[nodiscard]] bool is_exact(const Eigen::Vector3d& p) const;

  // The samples that copies share; the constructor below makes the same grid from them.
  [[nodiscard]] const std::shared_ptr<const Samples>& samples() const { return samples_; }
  explicit DistanceGrid(std::shared_ptr<const Samples> samples) : samples_(std::move(samples)) {}

 private:
  using Distance = std::function<double(const Eigen::Vector3d&)>;
  // Makes the grid without marks.
  static std::shared_ptr<Samples> sampled(const Distance& distance, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                          double cell);
  [[nodiscard]] static SurfacePoint outside(const Samples& grid, double x, double y, double z);
  [[nodiscard]] std::optional<SurfacePoint> met_by_entry(const Eigen::Vector3d& p, const Eigen::Vector3d& axis, double column,
                                                         const Nearest& nearest) const;

  std::shared_ptr<const Samples> samples_;
};

}  // namespace slipbench
