#include "tools/base/statistics/auc.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tools/base/statistics/descriptive.h"

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

std::vector<double> sorted(std::span<const double> values) {
  if (values.empty() || std::ranges::any_of(values, [](double value) { return std::isnan(value); })) {
    throw std::invalid_argument("auc: a class without values, or with one that is no number");
  }
  std::vector<double> result(values.begin(), values.end());
  std::ranges::sort(result);
  return result;
}

// What the values of a group are above or below what is expected of that many: of its positives against all negatives, and the other way.
struct Group {
  double positives = 0.0, negatives = 0.0;
  bool has_positives = false, has_negatives = false;
};

// n/(n - 1) for the bias of a variance about its own mean; of one group nothing is known, and it adds nothing.
double unbiased(std::size_t groups) { return groups < 2 ? 0.0 : static_cast<double>(groups) / static_cast<double>(groups - 1); }

}  // namespace

Auc auc(std::span<const double> positives, std::span<const std::size_t> positive_group, std::span<const double> negatives,
        std::span<const std::size_t> negative_group) {
  if (positive_group.size() != positives.size() || negative_group.size() != negatives.size()) {
    throw std::invalid_argument("auc: not one group for each value");
  }
  constexpr double quantile = 1.959963984540054;  // of the normal distribution, 97.5 %
  const std::vector<double> above = shares_below(positives, sorted(negatives)),
                            below = shares_below(negatives, sorted(positives));
  Auc result{mean_sd(above).mean, {}, positives.size(), negatives.size()};
  std::map<std::size_t, Group> groups;
  for (std::size_t i = 0; i < above.size(); ++i) {
    Group& group = groups[positive_group[i]];
    group.positives += above[i] - result.value;
    group.has_positives = true;
  }
  for (std::size_t i = 0; i < below.size(); ++i) {
    Group& group = groups[negative_group[i]];
    group.negatives += 1.0 - below[i] - result.value;
    group.has_negatives = true;
  }
  std::size_t with_positives = 0, with_negatives = 0;
  double of_positives = 0.0, of_negatives = 0.0, of_both = 0.0;
  for (const auto& [number, group] : groups) {
    with_positives += group.has_positives ? 1 : 0;
    with_negatives += group.has_negatives ? 1 : 0;
    of_positives += group.positives * group.positives;
    of_negatives += group.negatives * group.negatives;
    of_both += group.positives * group.negatives;
  }
  if (result.value == 0.0 || result.value == 1.0) {
    const std::size_t pairs = std::min(with_positives, with_negatives);
    result.interval = clopper_pearson(result.value == 1.0 ? pairs : 0, pairs);
    return result;
  }
  const auto m = static_cast<double>(positives.size()), n = static_cast<double>(negatives.size());
  const double variance = unbiased(with_positives) * of_positives / (m * m) + unbiased(with_negatives) * of_negatives / (n * n) +
                          2.0 * unbiased(groups.size()) * of_both / (m * n);
  const double reach = quantile * std::sqrt(std::max(0.0, variance));
  result.interval = {std::max(0.0, result.value - reach), std::min(1.0, result.value + reach)};
  return result;
}

Auc auc(std::span<const double> positives, std::span<const double> negatives) {
  std::vector<std::size_t> alone(positives.size() + negatives.size());
  std::iota(alone.begin(), alone.end(), std::size_t{0});
  const std::span<const std::size_t> all(alone);
  return auc(positives, all.first(positives.size()), negatives, all.last(negatives.size()));
}

}  // namespace slipbench
