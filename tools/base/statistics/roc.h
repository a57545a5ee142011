// How well a score tells two kinds apart: the area under the curve, and the curve.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tools/base/statistics/descriptive.h"

namespace slipbench {

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
