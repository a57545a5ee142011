#include "sim/contact/surface/distance_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
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
  // Mark of the cell whose first coefficient has the same index; empty: the spline everywhere.
  std::vector<std::uint8_t> marks;
  FindNearest near_kinks;
  FindCrossings crossings;
};

namespace {

constexpr double margin = 3.0;  // cells between the box and the edge of the grid
// samples beyond the edge of the grid: 2 for the filter and 1 for the spline
constexpr std::size_t reach = 3;
constexpr std::size_t filter_reach = 2;

// Bits of a cell's mark: the corner at its lower (0) or upper end (1) along x, y and z, at bit
// 4 x + 2 y + z, is a corner of a cell within reach of a kink. 0: the cell uses the spline; all: it
// calls the function.
constexpr std::uint8_t all_corners = 0xFF;

constexpr double least_cosine = 0.94;      // of 20 degrees: between normals at neighbouring nodes, away from kinks
constexpr double largest_rounding = 0.05;  // cells, of the spline at points of the surface
// Samples along each axis that a cell's spline depends on, beginning at the one with the cell's index.
constexpr std::size_t support = 2 * reach + 2;

using Counts = std::array<std::size_t, 3>;
using Marks = std::vector<std::uint8_t>;

// Number of values between neighbours along an axis.
std::size_t stride_of(const Counts& counts, std::size_t axis) {
  std::size_t stride = 1;
  for (std::size_t k = axis + 1; k < 3; ++k) stride *= counts[k];
  return stride;
}

// Returns the number of nodes with a sample, along one axis.
double sampled_nodes(double extent, double cell) { return std::ceil(extent / cell) + 2.0 * margin + 1.0 + 2.0 * reach; }

// Returns how far p lies outside the box, along each axis.
Eigen::Vector3d beyond(const Eigen::Vector3d& p, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return (low - p).cwiseMax(p - high).cwiseMax(0.0);
}

// Applies the filter of the class comment along one axis, which loses filter_reach nodes at either
// end.
std::vector<double> filtered(const std::vector<double>& f, Counts& counts, std::size_t axis) {
  const std::size_t stride = stride_of(counts, axis);
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

// Returns, for each index from which `width` values along the axis follow, whether one of them is
// set. Reduces the count along the axis.
Marks any_in_window(const Marks& marks, Counts& counts, std::size_t axis, std::size_t width) {
  const std::size_t stride = stride_of(counts, axis), kept = counts[axis] + 1 - width;
  const std::size_t lines = marks.size() / (stride * counts[axis]);
  Marks any(lines * kept * stride, 0);
  for (std::size_t line = 0; line < lines; ++line) {
    for (std::size_t i = 0; i < kept * stride; ++i) {
      const std::uint8_t* from = marks.data() + line * counts[axis] * stride + i;
      std::uint8_t set = 0;
      for (std::size_t j = 0; j < width; ++j) set |= from[j * stride];
      any[line * kept * stride + i] = set;
    }
  }
  counts[axis] = kept;
  return any;
}

// Returns the cells, as many as `cells` along each axis, whose spline depends on a marked sample (of
// `counts` samples); of marked pairs along an axis, `counts` is one less there.
Marks cells_within_reach(Marks marks, Counts counts, const Counts& cells) {
  for (std::size_t axis = 0; axis < 3; ++axis) marks = any_in_window(marks, counts, axis, counts[axis] + 1 - cells[axis]);
  return marks;
}

// Returns which pairs of neighbouring samples along an axis have a kink between them.
Marks kinks_along(const std::vector<Eigen::Vector3f>& normals, Counts& counts, std::size_t axis) {
  const std::size_t stride = stride_of(counts, axis), line_size = counts[axis] * stride;
  Marks kinks;
  kinks.reserve(normals.size());
  for (std::size_t line = 0; line < normals.size(); line += line_size) {
    for (std::size_t i = line; i + stride < line + line_size; ++i) {
      kinks.push_back(normals[i].dot(normals[i + stride]) < least_cosine ? 1 : 0);
    }
  }
  --counts[axis];
  return kinks;
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

std::shared_ptr<DistanceGrid::Samples> DistanceGrid::sampled(const Distance& distance, const Eigen::Vector3d& low,
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
  return grid;
}

DistanceGrid::DistanceGrid(const Distance& distance, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double cell)
    : samples_(sampled(distance, low, high, cell)) {}

DistanceGrid::DistanceGrid(const FindNearest& nearest, FindNearest near_kinks, FindCrossings crossings,
                           std::span<const Eigen::Vector3d> on_surface, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                           double cell) {
  std::vector<Eigen::Vector3f> normals;
  const std::shared_ptr<Samples> grid = sampled(
      [&](const Eigen::Vector3d& p) {
        const Nearest found = nearest(p);
        normals.push_back(found.normal.cast<float>());
        return found.distance;
      },
      low, high, cell);
  samples_ = grid;
  Counts cells, counts;
  for (std::size_t k = 0; k < 3; ++k) {
    cells[k] = static_cast<std::size_t>(grid->cells[k]);
    counts[k] = cells[k] + support - 1;
  }
  Marks exact(cells[0] * cells[1] * cells[2], 0);
  const auto add = [&](const Marks& more) {
    for (std::size_t i = 0; i < exact.size(); ++i) exact[i] |= more[i];
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Counts pairs = counts;
    const Marks kinks = kinks_along(normals, pairs, axis);
    add(cells_within_reach(kinks, pairs, cells));
  }
  // A detail between the nodes shows where the spline is not 0 on the surface.
  Counts lower{counts[0] - 1, counts[1] - 1, counts[2] - 1};
  Marks details(lower[0] * lower[1] * lower[2], 0);
  for (const Eigen::Vector3d& p : on_surface) {
    if (at(p.x(), p.y(), p.z(), 0.0, 0.0, 0.0).gap <= largest_rounding * cell) continue;
    std::size_t index = 0;
    for (int k = 0; k < 3; ++k) {
      index = index * lower[static_cast<std::size_t>(k)] + static_cast<std::size_t>((p[k] - grid->first[k]) * grid->rate) + reach;
    }
    details[index] = 1;
  }
  add(cells_within_reach(std::move(details), lower, cells));
  grid->crossings = std::move(crossings);
  if (std::ranges::none_of(exact, [](std::uint8_t mark) { return mark != 0; })) return;

  const auto corner_of = [&grid](std::size_t first, unsigned corner) {
    return first + (corner >> 2U) * grid->stride_x + (corner >> 1U & 1U) * grid->stride_y + (corner & 1U);
  };
  const auto for_each_cell = [&](const auto& action) {
    std::size_t cell_at = 0;
    for (std::size_t i = 0; i < cells[0]; ++i) {
      for (std::size_t j = 0; j < cells[1]; ++j) {
        for (std::size_t k = 0; k < cells[2]; ++k) action(cell_at++, i * grid->stride_x + j * grid->stride_y + k);
      }
    }
  };
  Marks corners(grid->coefficients.size(), 0);
  for_each_cell([&](std::size_t cell_at, std::size_t first) {
    for (unsigned corner = 0; exact[cell_at] != 0 && corner < 8; ++corner) corners[corner_of(first, corner)] = 1;
  });
  grid->marks.assign(grid->coefficients.size(), 0);
  for_each_cell([&](std::size_t, std::size_t first) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      if (corners[corner_of(first, corner)] != 0)
        grid->marks[first] = static_cast<std::uint8_t>(grid->marks[first] | 1U << corner);
    }
  });
  grid->near_kinks = std::move(near_kinks);
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

bool DistanceGrid::knows_crossings() const { return static_cast<bool>(samples_->crossings); }

std::optional<DistanceGrid::Entry> DistanceGrid::entry(const Eigen::Vector3d& p, const Eigen::Vector3d& axis) const {
  if (!knows_crossings()) return std::nullopt;
  const std::vector<Crossing> crossings = samples_->crossings(p, axis);
  // Shells whose faces differ by less [m] touch: the line does not leave the surface between them.
  constexpr double touching = 1e-7;
  const auto first_ahead = std::ranges::find_if(crossings, [](const Crossing& each) { return each.way > 0.0; });
  int around = 0;  // how often the surface winds around the point
  for (auto each = first_ahead; each != crossings.end(); ++each) around += each->leaves;
  if (around <= 0) return std::nullopt;
  // The first crossing from which the line is outside, in the direction of `sign`.
  const auto way_out = [&](auto each, const auto& end, int sign) {
    int inside = around;
    for (auto left = end; each != end; ++each) {
      if (left != end && std::abs(each->way - left->way) > touching) return left;
      inside -= sign * each->leaves;
      if (inside > 0) left = end;
      if (inside <= 0 && left == end) left = each;
      if (std::next(each) == end) return left;
    }
    return end;
  };
  const auto ahead = way_out(first_ahead, crossings.end(), 1);
  const auto back = way_out(std::make_reverse_iterator(first_ahead), crossings.rend(), -1);
  if (ahead == crossings.end() || back == crossings.rend()) return std::nullopt;
  return Entry{-back->way, ahead->way, back->normal};
}

bool DistanceGrid::passes_through(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& axis,
                                  const Eigen::Vector3d& pressed_on) const {
  const double length = (to - from).norm();
  if (!knows_crossings() || !(length > 0.0)) return false;
  constexpr double opposite = -0.5;  // cosine between the normals of two sides of a wall
  std::optional<Eigen::Vector3d> side;
  if (!pressed_on.isZero(0.0)) side = pressed_on;
  bool through = false;
  for (const Crossing& each : samples_->crossings(from, (to - from) / length)) {
    if (each.way < 0.0 || each.way > length) continue;
    if (each.leaves < 0) {
      through = false;  // in another wall, or back in the same one
      if (!side && each.normal.dot(axis) < 0.0) side = each.normal;
    } else if (each.leaves > 0 && side) {
      through = each.normal.dot(*side) < opposite;
    }
  }
  return through;
}

// Returns the contact with the face that an element inside the surface entered, unless it meets the
// nearest point.
std::optional<SurfacePoint> DistanceGrid::met_by_entry(const Eigen::Vector3d& p, const Eigen::Vector3d& axis, double column,
                                                       const Nearest& nearest) const {
  constexpr double steep = -0.5;     // cosine between axis and normal
  constexpr double same_side = 0.5;  // cosine between normals: the surface bends, without an edge in between
  const double along = nearest.normal.dot(axis);
  if (along < steep && !nearest.hidden) return std::nullopt;
  const std::optional<Entry> entry = this->entry(p, axis);
  if (!entry || !(entry->normal.dot(axis) < 0.0)) return std::nullopt;
  const bool is_met = along < 0.0 && !nearest.hidden;
  if (is_met && entry->normal.dot(nearest.normal) > same_side) return std::nullopt;
  const bool reaches = entry->back <= entry->ahead || (entry->back <= column && (std::isfinite(column) || !is_met));
  if (!reaches) return std::nullopt;
  const Eigen::Vector3d& n = entry->normal;
  return SurfacePoint{entry->back * n.dot(axis), n.x(), n.y(), n.z(), entered};
}

SurfacePoint DistanceGrid::at(double x, double y, double z, double ax, double ay, double az, double column) const {
  const Samples& grid = *samples_;
  const double u = (x - grid.first.x()) * grid.rate, v = (y - grid.first.y()) * grid.rate, w = (z - grid.first.z()) * grid.rate;
  if (!(u >= 0.0 && v >= 0.0 && w >= 0.0 && u < grid.cells[0] && v < grid.cells[1] && w < grid.cells[2])) {
    return outside(grid, x, y, z);
  }
  const auto i = static_cast<std::size_t>(u), j = static_cast<std::size_t>(v), k = static_cast<std::size_t>(w);
  const std::size_t first = i * grid.stride_x + j * grid.stride_y + k;
  const auto met = [&](double gap, double nx, double ny, double nz, bool hidden = false) -> SurfacePoint {
    if (gap < 0.0) {
      const auto entered_by = met_by_entry({x, y, z}, {ax, ay, az}, column, {gap, {nx, ny, nz}, hidden});
      if (entered_by) return *entered_by;
    }
    return {nx * ax + ny * ay + nz * az < 0.0 ? gap : std::abs(gap), nx, ny, nz};
  };
  const std::uint8_t mark = grid.marks.empty() ? std::uint8_t{0} : grid.marks[first];
  if (mark == all_corners) {
    const Nearest exact = grid.near_kinks({x, y, z});
    return met(exact.distance, exact.normal.x(), exact.normal.y(), exact.normal.z(), exact.hidden);
  }
  const Weights along_x(u - static_cast<double>(i)), along_y(v - static_cast<double>(j)), along_z(w - static_cast<double>(k));

  // Sums over x and y, for each of the four nodes along z, so that the compiler vectorises them.
  double value[4] = {}, slope_x[4] = {}, slope_y[4] = {};
  const double* plane = grid.coefficients.data() + first;
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
  if (mark == 0) return met(gap, gx / steepness, gy / steepness, gz / steepness);

  const double along[3] = {u - static_cast<double>(i), v - static_cast<double>(j), w - static_cast<double>(k)};
  double share = 0.0;  // of the exact distance: 1 at marked corners, 0 at the others, trilinear in between
  for (unsigned corner = 0; corner < 8; ++corner) {
    if ((mark >> corner & 1U) == 0) continue;
    const auto weight = [&](int axis, unsigned bit) { return (corner >> bit & 1U) != 0 ? along[axis] : 1.0 - along[axis]; };
    share += weight(0, 2U) * weight(1, 1U) * weight(2, 0U);
  }
  const Nearest exact = grid.near_kinks({x, y, z});
  const Eigen::Vector3d n = (share * exact.normal + (1.0 - share) / steepness * Eigen::Vector3d(gx, gy, gz)).normalized();
  return met(share * exact.distance + (1.0 - share) * gap, n.x(), n.y(), n.z(), exact.hidden);
}

bool DistanceGrid::is_exact(const Eigen::Vector3d& p) const {
  const Samples& grid = *samples_;
  const Eigen::Vector3d at = (p - grid.first) * grid.rate;
  if (grid.marks.empty() || !(at.minCoeff() >= 0.0)) return false;
  std::size_t index[3];
  for (int k = 0; k < 3; ++k) {
    if (!(at[k] < grid.cells[static_cast<std::size_t>(k)])) return false;
    index[k] = static_cast<std::size_t>(at[k]);
  }
  return grid.marks[index[0] * grid.stride_x + index[1] * grid.stride_y + index[2]] == all_corners;
}

}  // namespace slipbench
