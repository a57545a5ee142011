// How far a share of trials can be trusted.
#pragma once

#include <cstddef>

namespace slipbench {

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

}  // namespace slipbench
