#include "tools/run/auc.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace slipbench {
namespace {

// For each of `values` the share of `others` below it, equal ones counting half. `others` in ascending order.
std::vector<double> shares_below(std::span<const double> values, const std::vector<double>& others) {
  std::vector<double> shares;
  shares.reserve(values.size());
  for (const double value : values) {
    const auto [first, last] = std::equal_range(others.begin(), others.end(), value);
    const auto below = static_cast<double>(first - others.begin()), equal = static_cast<double>(last - first);
    shares.push_back((below + 0.5 * equal) / static_cast<double>(others.size()));
  }
  return shares;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// Variance of the mean of independent values; of one value nothing is known, and it adds nothing.
double variance_of_mean(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  const auto n = static_cast<double>(values.size());
  return sum / (n - 1.0) / n;
}

std::vector<double> sorted(std::span<const double> values) {
  if (values.empty() || std::ranges::any_of(values, [](double value) { return std::isnan(value); })) {
    throw std::invalid_argument("auc: a class without values, or with one that is no number");
  }
  std::vector<double> result(values.begin(), values.end());
  std::ranges::sort(result);
  return result;
}

}  // namespace

Auc auc(std::span<const double> positives, std::span<const double> negatives) {
  constexpr double quantile = 1.959963984540054;  // of the normal distribution, 97.5 %
  const std::vector<double> above = shares_below(positives, sorted(negatives)),
                            below = shares_below(negatives, sorted(positives));
  Auc result{mean_of(above), {}, positives.size(), negatives.size()};
  if (result.value == 0.0 || result.value == 1.0) {
    const std::size_t pairs = std::min(positives.size(), negatives.size());
    result.interval = clopper_pearson(result.value == 1.0 ? pairs : 0, pairs);
    return result;
  }
  const double reach = quantile * std::sqrt(variance_of_mean(above) + variance_of_mean(below));
  result.interval = {std::max(0.0, result.value - reach), std::min(1.0, result.value + reach)};
  return result;
}

}  // namespace slipbench
