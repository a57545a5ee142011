#include "tools/studies/hd_papillarray/hd_table2_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sim/core/pad_state.h"
#include "tools/base/statistics/descriptive.h"

namespace slipbench::reproduce {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The script's constants.
constexpr double most_force = 10.0;  // N
constexpr std::size_t window = 4;    // rows
constexpr std::size_t slips = 3;     // rows of a window

struct Row {
  std::span<const float> force;  // [N,3]
  PadState state;
};

std::vector<Row> rows_of(std::span<const float> force, std::span<const std::uint8_t> classes, std::size_t stride) {
  const std::size_t values = classes.empty() ? 0 : force.size() / classes.size();
  std::vector<Row> rows;
  for (std::size_t i = stride - 1; i < classes.size(); i += stride) {
    const std::span<const float> row = force.subspan(i * values, values);
    if (std::ranges::all_of(row, [](float value) { return std::isfinite(value); })) {
      rows.push_back({row, static_cast<PadState>(classes[i])});
    }
  }
  return rows;
}

double normal_force(const Row& row) {
  double sum = 0.0;
  for (std::size_t k = 2; k < row.force.size(); k += 3) sum += double{row.force[k]};
  return sum;
}

// sum f_t / mean(f_t/f_n); NaN where no ratio is below 1.
double ideal_force(const Row& row) {
  double tangential = 0.0, ratios = 0.0, n = 0.0;
  for (std::size_t k = 0; k < row.force.size(); k += 3) {
    const double shear = std::hypot(double{row.force[k]}, double{row.force[k + 1]});
    const double normal = double{row.force[k + 2]};
    tangential += shear;
    if (shear == 0.0 || normal == 0.0 || shear / normal >= 1.0) continue;
    ratios += shear / normal;
    n += 1.0;
  }
  return tangential * n / ratios;
}

std::vector<Row> incipient_rows(const std::vector<Row>& rows) {
  const auto incipient = [](const Row& row) { return row.state == PadState::incipient; };
  const auto slipping = [](const Row& row) { return row.state == PadState::incipient || row.state == PadState::gross; };
  std::vector<Row> found;
  std::size_t i = 0;
  while (i + window < rows.size()) {
    const std::span<const Row> part = std::span(rows).subspan(i, window);
    const bool counts = static_cast<std::size_t>(std::ranges::count_if(part, slipping)) >= slips;
    if (counts && std::ranges::any_of(part, incipient)) {
      std::ranges::copy_if(part, std::back_inserter(found), incipient);
      i += window;
    } else {
      ++i;
    }
  }
  return found;
}

// Smaller of two, a NaN left out.
double least(double a, double b) { return std::isnan(a) || b < a ? b : a; }

// Mean of samples [first, first + n) of the way from the arm's origin to the box's.
std::array<double, 3> mean_way(std::span<const float> arm, std::span<const float> box, std::size_t first, std::size_t n) {
  std::array<double, 3> mean{};
  for (std::size_t i = first; i < first + n; ++i) {
    for (std::size_t k = 0; k < 3; ++k) mean[k] += (double{box[7 * i + k]} - double{arm[7 * i + k]}) / static_cast<double>(n);
  }
  return mean;
}

double polar_angle(const std::array<double, 3>& v) { return std::atan2(std::hypot(v[0], v[1]), v[2]); }

}  // namespace

EstimatedForces estimated_forces(std::span<const float> force, std::span<const std::uint8_t> classes, std::size_t stride) {
  const std::vector<Row> rows = rows_of(force, classes, stride);
  EstimatedForces estimate{nan, nan};
  for (const Row& row : rows) {
    const double sum = normal_force(row);
    if (sum <= most_force) estimate.most = std::isnan(estimate.most) ? sum : std::max(estimate.most, sum);
  }
  for (const Row& row : incipient_rows(rows)) estimate.ideal = least(estimate.ideal, ideal_force(row));
  return estimate;
}

MarkerSlip marker_slip(std::span<const float> arm, std::span<const float> box, std::size_t lift) {
  constexpr std::size_t before = 51, after = 101;
  const std::size_t count = std::min(before, lift + 1);
  const std::array<double, 3> start = mean_way(arm, box, lift + 1 - count, count);
  const std::array<double, 3> end = mean_way(arm, box, arm.size() / 7 - after, after);
  const std::array<double, 3> line{marker_line[0], marker_line[1], marker_line[2]};
  std::array<double, 3> turned = line;
  for (std::size_t k = 0; k < 3; ++k) turned[k] += end[k] - start[k];
  return {std::abs(end[2] - start[2]), std::abs(polar_angle(turned) - polar_angle(line))};
}

Spread spread(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return {values.size(), median(values), median_interval(values), mean_sd(values)};
}

}  // namespace slipbench::reproduce
