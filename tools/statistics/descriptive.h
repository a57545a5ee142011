// Descriptive statistics of a sample.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace slipbench {

// Indices of at most `most` of `size` items, ascending, evenly spaced from the first item to the
// last. Only the first index if `most` is 1.
std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t most);

// part/all; NaN if `all` is 0.
inline double share_of(std::size_t part, std::size_t all) {
  return all == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(all);
}

// Confidence intervals of shares of trials.

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

// The exact two-sided interval of a share after k successes in n trials [clopper1934]: k or more
// successes at `low`, and k or fewer at `high`, have the probability (1 - confidence)/2. [0, 1] if
// n is 0. Throws std::logic_error if k > n or `confidence` is not within (0, 1).
Interval clopper_pearson(std::size_t k, std::size_t n, double confidence = 0.95);

// The fewest successes in n trials whose interval does not begin below `rate`; n + 1 if no number
// suffices.
std::size_t least_successes(std::size_t n, double rate, double confidence);

struct MeanSd {
  double mean = 0.0;
  double sd = 0.0;  // of the sample, n - 1; NaN for fewer than two values
};

// NaN for no values.
MeanSd mean_sd(std::span<const double> values);

// The p-quantile, 0 to 1, interpolated between the sorted values (type 7 of Hyndman and Fan,
// numpy's default); NaN for no values. No value may be NaN. Every quantile in the project uses this
// definition.
double quantile(std::vector<double> values, double p);

// quantile(values, 0.5): the middle value, or the mean of the middle two.
double median(std::vector<double> values);

// Median wall-clock time [s] of `passes` calls of `pass`.
double median_time(std::size_t passes, const std::function<void()>& pass);

// Confidence intervals of other figures of trials.

// 95 % intervals by the percentile bootstrap over groups [efron1979]. Each draw takes `groups`
// groups with replacement by RandomStream(seed, draw, "intervals"); an interval runs from the 2.5
// to the 97.5 % quantile of a figure over the draws. Dependent values in one group, such as frames
// of a trial, thus stay together.
// `figures` receives the numbers of the groups drawn, 0 to groups - 1, and returns the same number
// of figures each time; there is one interval per figure. A figure that is NaN in a draw is left
// out of its quantiles. Both ends are NaN for fewer than two groups and for a figure that is NaN in
// every draw. Throws std::logic_error for zero draws.
std::vector<Interval> bootstrap_intervals(std::size_t groups, std::size_t draws, std::uint64_t seed,
                                          const std::function<std::vector<double>(std::span<const std::size_t>)>& figures);

// Area under the receiver operating curve, and the curve.

// Separation of two classes by a number.

// Area under the receiver operating curve: the share of pairs of a positive and a negative in which
// the positive has the larger value, ties counting half. 1: a threshold separates the classes; 0.5:
// the number carries no information.
struct Auc {
  double value = 0.0;
  Interval interval;  // of 95 %
  std::size_t positives = 0, negatives = 0;
};

// Exact, by ranks (Mann and Whitney's U over m n). The interval is DeLong's [delong1988], by normal
// approximation and within [0, 1]. At 0 and at 1, where DeLong's variance vanishes, it is that of
// min(m, n) pairs without common values, all in one order (clopper_pearson). Throws
// std::invalid_argument if a class is empty or a value is NaN.
Auc auc(std::span<const double> positives, std::span<const double> negatives);

// As above for values in groups, such as frames in recordings: values within a group may depend on
// each other, groups do not. `..._group` holds the group number of each value; a group may have
// values of both classes. The interval is Obuchowski's [obuchowski1997], which equals DeLong's if
// each value is its own group; at 0 and at 1 it is that of the groups of the class that has fewer.
// Throws std::invalid_argument also if a list of groups differs in length from its values.
Auc auc(std::span<const double> positives, std::span<const std::size_t> positive_group, std::span<const double> negatives,
        std::span<const std::size_t> negative_group);

// Thresholds on probabilities, and calibration of probabilities.

// Effect of a threshold: the shares of negatives and of positives whose value is at least the
// threshold.
struct RocPoint {
  double threshold = 0.0;
  double false_share = 0.0, true_share = 0.0;
};

// The receiver operating curve from (0, 0), whose threshold is inf, to (1, 1): one point per
// distinct value, descending. If there are more than `most` points, `most` equally spaced ones are
// kept, including the first and the last. Throws std::invalid_argument if a class is empty, a value
// is NaN, or `most` is less than two.
std::vector<RocPoint> roc_curve(std::span<const double> positives, std::span<const double> negatives, std::size_t most);

// Values within one of equal parts of [0, 1].
struct CalibrationBin {
  double low = 0.0, high = 0.0;  // the last part includes its upper end
  std::size_t count = 0;         // values in it
  double mean = 0.0;             // of these values: predicted probability
  double share = 0.0;            // of positives among them: observed frequency
};

// The parts with values, ascending. Throws std::invalid_argument for a value outside [0, 1] and for
// zero parts.
std::vector<CalibrationBin> calibration(std::span<const double> positives, std::span<const double> negatives, std::size_t parts);

}  // namespace slipbench
