#include "tools/base/statistics/roc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace slipbench {

std::vector<RocPoint> roc_curve(std::span<const double> positives, std::span<const double> negatives, std::size_t most) {
  if (positives.empty() || negatives.empty()) throw std::invalid_argument("a receiver operating curve needs both classes");
  if (most < 2) throw std::invalid_argument("a receiver operating curve has two ends");
  std::vector<std::pair<double, bool>> values;
  for (const double value : positives) values.emplace_back(value, true);
  for (const double value : negatives) values.emplace_back(value, false);
  if (std::ranges::any_of(values, [](const auto& value) { return std::isnan(value.first); })) {
    throw std::invalid_argument("a receiver operating curve needs numbers");
  }
  std::ranges::sort(values, [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<RocPoint> points{{.threshold = std::numeric_limits<double>::infinity()}};
  std::size_t right = 0, wrong = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    ++(values[i].second ? right : wrong);
    if (i + 1 < values.size() && values[i + 1].first == values[i].first) continue;
    points.push_back({values[i].first, static_cast<double>(wrong) / static_cast<double>(negatives.size()),
                      static_cast<double>(right) / static_cast<double>(positives.size())});
  }
  if (points.size() <= most) return points;
  std::vector<RocPoint> kept;
  for (std::size_t k = 0; k < most; ++k) kept.push_back(points[k * (points.size() - 1) / (most - 1)]);
  return kept;
}

std::vector<CalibrationBin> calibration(std::span<const double> positives, std::span<const double> negatives, std::size_t parts) {
  if (parts == 0) throw std::invalid_argument("a calibration needs a part");
  const auto n = static_cast<double>(parts);
  std::vector<CalibrationBin> bins(parts);
  const auto add = [&](double value, double positive) {
    if (!(value >= 0.0 && value <= 1.0)) throw std::invalid_argument("a probability is not within 0 and 1");
    CalibrationBin& bin = bins[std::min(static_cast<std::size_t>(value * n), parts - 1)];
    ++bin.count;
    bin.mean += value;
    bin.share += positive;
  };
  for (const double value : positives) add(value, 1.0);
  for (const double value : negatives) add(value, 0.0);
  for (std::size_t k = 0; k < parts; ++k) {
    CalibrationBin& bin = bins[k];
    bin.low = static_cast<double>(k) / n;
    bin.high = static_cast<double>(k + 1) / n;
    bin.mean /= static_cast<double>(bin.count);
    bin.share /= static_cast<double>(bin.count);
  }
  std::erase_if(bins, [](const CalibrationBin& bin) { return bin.count == 0; });
  return bins;
}

}  // namespace slipbench
