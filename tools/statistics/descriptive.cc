#include "tools/statistics/descriptive.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "sim/core/math.h"
#include "sim/core/random.h"

namespace slipbench {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Probability of k or more successes in n trials with p in (0, k/n]; the terms decrease from k on.
double upper_tail(double k, double n, double p) {
  double term = math::exp(math::lgamma(n + 1.0) - math::lgamma(k + 1.0) - math::lgamma(n - k + 1.0) + k * math::log(p) +
                          (n - k) * math::log1p(-p));
  double sum = 0.0;
  for (double i = k; i <= n && term > std::numeric_limits<double>::epsilon() * sum; ++i) {
    sum += term;
    term *= (n - i) / (i + 1.0) * p / (1.0 - p);
  }
  return sum;
}

double lower_bound(std::size_t k, std::size_t n, double outside) {
  if (k == 0) return 0.0;
  const auto [count, all] = std::pair{static_cast<double>(k), static_cast<double>(n)};
  if (k == n) return math::pow(outside, 1.0 / all);
  double low = 0.0;
  double high = count / all;
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return middle;  // adjacent doubles
    (upper_tail(count, all, middle) < outside ? low : high) = middle;
  }
}

// For each of `values` the share of `others` below it, ties counting half. `others` in ascending
// order.
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
    throw std::invalid_argument("auc: a class has no values, or a value is NaN");
  }
  std::vector<double> result(values.begin(), values.end());
  std::ranges::sort(result);
  return result;
}

// Sums over a group of the deviations from the expected shares: of its positives against all
// negatives, and vice versa.
struct Group {
  double positives = 0.0, negatives = 0.0;
  bool has_positives = false, has_negatives = false;
};

// n/(n - 1), which corrects the bias of a variance about its own mean; 0 for fewer than two groups,
// whose variance is unknown.
double unbiased(std::size_t groups) { return groups < 2 ? 0.0 : static_cast<double>(groups) / static_cast<double>(groups - 1); }

}  // namespace

std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t most) {
  const std::size_t count = std::min(size, most);
  if (count == 1) return {0};
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < count; ++k) indices.push_back(k * (size - 1) / (count - 1));
  return indices;
}

MeanSd mean_sd(std::span<const double> values) {
  if (values.empty()) return {nan, nan};
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return {mean, values.size() < 2 ? nan : std::sqrt(squares / (n - 1.0))};
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return nan;
  std::ranges::sort(values);
  const double place = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - std::floor(place)) * (values[above] - values[below]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double median_time(std::size_t passes, const std::function<void()>& pass) {
  std::vector<double> times;
  for (std::size_t k = 0; k < passes; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    pass();
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return median(std::move(times));
}

std::vector<Interval> bootstrap_intervals(std::size_t groups, std::size_t draws, std::uint64_t seed,
                                          const std::function<std::vector<double>(std::span<const std::size_t>)>& figures) {
  if (draws == 0) throw std::logic_error("a bootstrap needs a draw");
  std::vector<std::size_t> drawn(groups);
  std::vector<std::vector<double>> values;  // [figure][draw]
  for (std::size_t draw = 0; draw < draws; ++draw) {
    RandomStream stream(seed, draw, "intervals");
    for (std::size_t& group : drawn) group = stream.integer(groups);
    const std::vector<double> found = figures(drawn);
    values.resize(found.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (!std::isnan(found[k])) values[k].push_back(found[k]);
    }
  }
  if (groups < 2) return std::vector<Interval>(values.size(), Interval{nan, nan});
  std::vector<Interval> intervals;
  for (const std::vector<double>& of_figure : values) {
    intervals.push_back({quantile(of_figure, 0.025), quantile(of_figure, 0.975)});
  }
  return intervals;
}

Interval clopper_pearson(std::size_t k, std::size_t n, double confidence) {
  if (k > n || !(confidence > 0.0 && confidence < 1.0)) throw std::logic_error("no such binomial interval");
  if (n == 0) return {};
  const double outside = 0.5 * (1.0 - confidence);
  return {lower_bound(k, n, outside), 1.0 - lower_bound(n - k, n, outside)};
}

std::size_t least_successes(std::size_t n, double rate, double confidence) {
  std::size_t from = 0;
  std::size_t to = n + 1;
  while (from < to) {
    const std::size_t middle = from + (to - from) / 2;
    if (clopper_pearson(middle, n, confidence).low < rate) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  return from;
}

Auc auc(std::span<const double> positives, std::span<const std::size_t> positive_group, std::span<const double> negatives,
        std::span<const std::size_t> negative_group) {
  if (positive_group.size() != positives.size() || negative_group.size() != negatives.size()) {
    throw std::invalid_argument("auc: the number of groups differs from the number of values");
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
  std::vector<RocPoint> kept;
  for (const std::size_t k : evenly_spaced(points.size(), most)) kept.push_back(points[k]);
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
