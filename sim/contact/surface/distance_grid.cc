#include "sim/contact/surface/distance_grid.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace slipbench {

struct DistanceGrid::Samples {
  Eigen::Vector3d low, high;         // m, the box around the surface
  Eigen::Vector3d first;             // m, the grid's lowest corner
  double cell, rate;                 // m, 1/m
  std::array<double, 3> cells;       // along x, y, z
  std::size_t stride_x, stride_y;    // in coefficients; 1 along z
  std::vector<double> coefficients;  // m, cells + 3 along each axis
};

namespace {

constexpr double margin = 3.0;  // cells between the box and the edge of the grid
// samples beyond the edge of the grid: 2 for the filter and 1 for the spline
constexpr std::size_t reach = 3;
constexpr std::size_t filter_reach = 2;

using Counts = std::array<std::size_t, 3>;

// Returns the number of nodes with a sample, along one axis.
double sampled_nodes(double extent, double cell) { return std::ceil(extent / cell) + 2.0 * margin + 1.0 + 2.0 * reach; }

// Returns how far p lies outside the box, along each axis.
Eigen::Vector3d beyond(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0);
}

// Applies the filter of the class comment along one axis, which loses filter_reach nodes at either
// end.
std::vector<double> filtered(const std::vector<double>& f, Counts& counts, std::size_t axis) {
  std::size_t stride = 1;
  for (std::size_t k = axis + 1; k < 3; ++k) stride *= counts[k];
  const std::size_t kept = counts[axis] - 2 * filter_reach, lines = f.size() / (stride * counts[axis]);
  std::vector<double> c(lines * kept * stride);
  for (std::size_t line = 0; line < lines; ++line) {
    for (std::size_t i = 0; i < kept; ++i) {
      const double* in = f.data() + (line * counts[axis] + i) * stride;
      double* out = c.data() + (line * kept + i) * stride;
      for (std::size_t j = 0; j < stride; ++j) {
        const double far = in[j] + in[j + 4 * stride], near = in[j + stride] + in[j + 3 * stride];
        out[j] = (far - 10.0 * near + 54.0 * in[j + 2 * stride]) / 36.0;
      }
    }
  }
  counts[axis] = kept;
  return c;
}

// The four cubic B-splines whose support contains a point at the fraction t of a cell, and their
// slopes per cell.
struct Weights {
  double value[4], slope[4];

  explicit Weights(double t) {
    const double s = 1.0 - t;
    value[0] = s * s * s / 6.0;
    value[1] = (4.0 - 3.0 * t * t * (1.0 + s)) / 6.0;
    value[2] = (4.0 - 3.0 * s * s * (1.0 + t)) / 6.0;
    value[3] = t * t * t / 6.0;
    slope[0] = -0.5 * s * s;
    slope[1] = 0.5 * t * (3.0 * t - 4.0);
    slope[2] = 0.5 * s * (4.0 - 3.0 * s);
    slope[3] = 0.5 * t * t;
  }
};

double sum_of_products(const double (&a)[4], const double (&b)[4]) {
  return (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3]);
}

}  // namespace

DistanceGrid::DistanceGrid(const std::function<double(const Eigen::Vector3d&)>& distance, const Eigen::Vector3d& low,
                           const Eigen::Vector3d& high, double cell) {
  const auto refuse = [](const std::string& what) { throw std::invalid_argument("distance grid: " + what); };
  const Eigen::Vector3d extent = high - low;
  if (!low.allFinite() || !high.allFinite() || !(extent.minCoeff() > 0.0)) refuse("the box must be finite and not empty");
  if (!(cell > 0.0) || !std::isfinite(cell)) refuse("the cell must be positive and finite");
  Counts counts;
  double nodes = 1.0;
  for (int k = 0; k < 3; ++k) nodes *= sampled_nodes(extent[k], cell);
  if (!(nodes <= static_cast<double>(max_nodes))) refuse("more than " + std::to_string(max_nodes) + " nodes; use a larger cell");
  for (std::size_t k = 0; k < 3; ++k) counts[k] = static_cast<std::size_t>(sampled_nodes(extent[static_cast<int>(k)], cell));

  auto grid = std::make_shared<Samples>();
  grid->low = low;
  grid->high = high;
  grid->cell = cell;
  grid->rate = 1.0 / cell;
  for (std::size_t k = 0; k < 3; ++k) {
    grid->cells[k] = static_cast<double>(counts[k] - 1 - 2 * reach);
    const int axis = static_cast<int>(k);
    grid->first[axis] = 0.5 * (low[axis] + high[axis] - cell * grid->cells[k]);
  }

  std::vector<double> samples;
  samples.reserve(counts[0] * counts[1] * counts[2]);
  const auto coordinate = [&](std::size_t k, std::size_t i) {
    return grid->first[static_cast<int>(k)] + (static_cast<double>(i) - static_cast<double>(reach)) * cell;
  };
  for (std::size_t i = 0; i < counts[0]; ++i) {
    for (std::size_t j = 0; j < counts[1]; ++j) {
      for (std::size_t k = 0; k < counts[2]; ++k) {
        const Eigen::Vector3d p(coordinate(0, i), coordinate(1, j), coordinate(2, k));
        const double sample = distance(p);
        if (!std::isfinite(sample)) refuse("a sample is not finite");
        // Tolerance of a millionth of a cell: a surface that touches its box is as near as the box,
        // up to rounding.
        const double to_box = beyond(p, low, high).norm();
        if (to_box > 0.0 && sample < to_box - 1e-6 * cell) refuse("the surface does not lie within its box");
        samples.push_back(sample);
      }
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) samples = filtered(samples, counts, axis);
  grid->stride_y = counts[2];
  grid->stride_x = counts[1] * counts[2];
  grid->coefficients = std::move(samples);
  samples_ = std::move(grid);
}

double DistanceGrid::cell_for(const Eigen::Vector3d& extent, std::size_t nodes) {
  const auto fits = [&](double cell) {
    return sampled_nodes(extent[0], cell) * sampled_nodes(extent[1], cell) * sampled_nodes(extent[2], cell) <=
           static_cast<double>(nodes);
  };
  double low = 0.0, high = extent.maxCoeff();
  while (!fits(high)) high *= 2.0;
  for (int bit = 0; bit < 52; ++bit) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? high : low) = middle;
  }
  return high;
}

double DistanceGrid::cell() const { return samples_->cell; }

std::size_t DistanceGrid::nodes() const { return samples_->coefficients.size(); }

SurfacePoint DistanceGrid::outside(const Samples& grid, double x, double y, double z) {
  const Eigen::Vector3d p(x, y, z);
  const Eigen::Vector3d off = beyond(p, grid.low, grid.high);
  const double distance = off.norm();
  const Eigen::Vector3d middle = 0.5 * (grid.low + grid.high);
  return {distance, std::copysign(off.x(), x - middle.x()) / distance, std::copysign(off.y(), y - middle.y()) / distance,
          std::copysign(off.z(), z - middle.z()) / distance};
}

SurfacePoint DistanceGrid::at(double x, double y, double z, double ax, double ay, double az) const {
  const Samples& grid = *samples_;
  const double u = (x - grid.first.x()) * grid.rate, v = (y - grid.first.y()) * grid.rate, w = (z - grid.first.z()) * grid.rate;
  if (!(u >= 0.0 && v >= 0.0 && w >= 0.0 && u < grid.cells[0] && v < grid.cells[1] && w < grid.cells[2])) {
    return outside(grid, x, y, z);
  }
  const auto i = static_cast<std::size_t>(u), j = static_cast<std::size_t>(v), k = static_cast<std::size_t>(w);
  const Weights along_x(u - static_cast<double>(i)), along_y(v - static_cast<double>(j)), along_z(w - static_cast<double>(k));

  // Sums over x and y, for each of the four nodes along z, so that the compiler vectorises them.
  double value[4] = {}, slope_x[4] = {}, slope_y[4] = {};
  const double* plane = grid.coefficients.data() + i * grid.stride_x + j * grid.stride_y + k;
  for (const std::size_t a : {0U, 1U, 2U, 3U}) {
    const double* line = plane + a * grid.stride_x;
    double plane_value[4] = {}, plane_slope[4] = {};
    for (const std::size_t b : {0U, 1U, 2U, 3U}) {
      for (const std::size_t c : {0U, 1U, 2U, 3U}) {
        plane_value[c] += along_y.value[b] * line[b * grid.stride_y + c];
        plane_slope[c] += along_y.slope[b] * line[b * grid.stride_y + c];
      }
    }
    for (const std::size_t c : {0U, 1U, 2U, 3U}) {
      value[c] += along_x.value[a] * plane_value[c];
      slope_x[c] += along_x.slope[a] * plane_value[c];
      slope_y[c] += along_x.value[a] * plane_slope[c];
    }
  }
  const double gap = sum_of_products(value, along_z.value);
  const double gx = sum_of_products(slope_x, along_z.value), gy = sum_of_products(slope_y, along_z.value),
               gz = sum_of_products(value, along_z.slope);
  const double steepness = std::sqrt(gx * gx + gy * gy + gz * gz);
  if (steepness == 0.0) return {std::abs(gap), ax, ay, az};
  const double nx = gx / steepness, ny = gy / steepness, nz = gz / steepness;
  return {nx * ax + ny * ay + nz * az < 0.0 ? gap : std::abs(gap), nx, ny, nz};
}

}  // namespace slipbench
