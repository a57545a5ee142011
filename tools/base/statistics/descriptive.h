// What a sample of values comes to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace slipbench {

// Indices of at most `most` of `size` items, ascending, evenly spaced from the first item to the last.
// Only the first item's where `most` is 1.
std::vector<std::size_t> evenly_spaced(std::size_t size, std::size_t most);

// part/all; NaN where that is none.
inline double share_of(std::size_t part, std::size_t all) {
  return all == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(all);
}

// How far a share of trials can be trusted.

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

// The exact two-sided interval of a share of which k of n trials are known (C. J. Clopper, E. S. Pearson, Biometrika 26, 1934): at `low`
// as many successes as k or more, at `high` as many as k or fewer have the probability (1 - confidence)/2. [0, 1] where n is 0. Throws
// std::logic_error where k > n or `confidence` is not within (0, 1).
Interval clopper_pearson(std::size_t k, std::size_t n, double confidence = 0.95);

// The fewest successes of n trials whose interval does not begin below `rate`; n + 1 where none does.
std::size_t least_successes(std::size_t n, double rate, double confidence);

struct MeanSd {
  double mean = 0.0;
  double sd = 0.0;  // of the sample, n - 1; NaN of fewer than two
};

// NaN of none.
MeanSd mean_sd(std::span<const double> values);

// The p-quantile, 0 to 1, interpolated between the sorted values (type 7 of Hyndman and Fan, numpy's default); NaN of none. No value may be
// NaN. The house has no other definition.
double quantile(std::vector<double> values, double p);

// quantile(values, 0.5): the middle value, or the mean of the middle two.
double median(std::vector<double> values);

// The median over `passes` of how long `pass` takes [s of the wall clock].
double median_time(std::size_t passes, const std::function<void()>& pass);

// How far figures of trials can be trusted that are no shares of trials.

// Intervals of 95 % by the percentile bootstrap over groups (B. Efron, Ann. Stat. 7, 1979): as many groups as there are, drawn with
// replacement by RandomStream(seed, draw, "intervals"), and between the 2.5 and 97.5 % quantiles of what `figures` makes of each draw. So
// what depends on each other within a group, as frames of a trial do, stays together.
// `figures` is handed the numbers of the groups drawn, 0 to groups - 1, and returns the same number of figures each time, as many as intervals
// come back. A figure that is NaN in a draw is left out of its quantiles. Both ends are NaN for fewer than two groups and for a figure
// that is NaN in every draw. Throws std::logic_error for no draws.
std::vector<Interval> bootstrap_intervals(std::size_t groups, std::size_t draws, std::uint64_t seed,
                                          const std::function<std::vector<double>(std::span<const std::size_t>)>& figures);

// How well a score tells two kinds apart: the area under the curve, and the curve.

// How well a number tells two classes apart.

// Area under the receiver operating curve: the share of pairs of a positive and a negative in which the positive has the larger value, ties
// counting half. 1: a threshold separates them; 0.5: the number says nothing.
struct Auc {
  double value = 0.0;
  Interval interval;  // of 95 %
  std::size_t positives = 0, negatives = 0;
};

// Exact, by ranks (Mann and Whitney's U over m n). The interval is DeLong's (Biometrics 44, 1988), by normal approximation and within [0, 1]:
// at 0 and at 1, where its variance vanishes, it is that of min(m, n) pairs that share no value, all in one order (clopper_pearson). Throws
// std::invalid_argument where a class is empty or a value is no number.
Auc auc(std::span<const double> positives, std::span<const double> negatives);

// The same of values that come in groups, as frames do in recordings: values of one group may depend on each other, groups do not. `..._group`
// holds the number of the group of each value; a group may have values of both classes. The interval is Obuchowski's (Biometrics 53, 1997),
// which is DeLong's where each value is a group of its own; at 0 and at 1 it is that of the groups of the class that has fewer. Throws
// std::invalid_argument also where a list of groups has not the length of its values.
Auc auc(std::span<const double> positives, std::span<const std::size_t> positive_group, std::span<const double> negatives,
        std::span<const std::size_t> negative_group);

// Numbers from 0 to 1 that say how likely something is: what a threshold on them does, and whether they are true.

// What a threshold does: the shares of negatives and of positives whose value is at least that.
struct RocPoint {
  double threshold = 0.0;
  double false_share = 0.0, true_share = 0.0;
};

// The receiver operating curve from (0, 0), whose threshold is inf, to (1, 1): a point at each value that occurs, falling. Of more than
// `most` points those at equal distances are kept, the first and the last among them. Throws std::invalid_argument where a class is
// empty, a value is no number, or `most` is less than two.
std::vector<RocPoint> roc_curve(std::span<const double> positives, std::span<const double> negatives, std::size_t most);

// Values of one of equal parts of [0, 1].
struct CalibrationBin {
  double low = 0.0, high = 0.0;  // the last one holds its end too
  std::size_t count = 0;         // values in it
  double mean = 0.0;             // of these values: what was said
  double share = 0.0;            // of positives among them: what was true
};

// The parts that hold values, ascending. Throws std::invalid_argument for a value outside [0, 1] and for no parts.
std::vector<CalibrationBin> calibration(std::span<const double> positives, std::span<const double> negatives, std::size_t parts);

}  // namespace slipbench
