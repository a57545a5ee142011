// How well a number tells two classes apart.
#pragma once

#include <cstddef>
#include <span>

#include "tools/base/statistics/binomial.h"

namespace slipbench {

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

}  // namespace slipbench
