// How far a count of successes tells a rate.
#pragma once

#include <cstddef>

namespace slipbench {

struct RateInterval {
  double low = 0.0;
  double high = 1.0;
};

// The exact (Clopper-Pearson) interval of the rate of which `successes` of `trials` were seen: at either of its ends what was seen, or
// what is further away from it, has the probability (1 - confidence)/2. `trials` at least 1, `successes` at most that, confidence within
// (0, 1). Clopper and Pearson, Biometrika 26 (1934) 404.
RateInterval exact_interval(std::size_t successes, std::size_t trials, double confidence);

// The fewest successes of `trials` whose interval does not begin below `rate`; trials + 1 where none does.
std::size_t least_successes(std::size_t trials, double rate, double confidence);

}  // namespace slipbench
