// What a sample of values comes to.
#pragma once

#include <span>
#include <vector>

#include "tools/base/statistics/binomial.h"

namespace slipbench {

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

// The interval of 95 % of a median, whatever the distribution: between the r-th smallest and the r-th largest value, with the largest r for which
// fewer than r values lie on one side of the median with a probability of at most 2.5 %, the number on a side being binomial with 1/2. NaN
// of fewer than six values.
Interval median_interval(std::vector<double> values);

}  // namespace slipbench
