// How far figures of trials can be trusted that are no shares of trials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/base/statistics/binomial.h"

namespace slipbench {

// Intervals of 95 % by the percentile bootstrap over groups (B. Efron, Ann. Stat. 7, 1979): as many groups as there are, drawn with
// replacement by RandomStream(seed, draw, "intervals"), and between the 2.5 and 97.5 % quantiles of what `figures` makes of each draw. So
// what depends on each other within a group, as frames of a trial do, stays together.
// `figures` is handed the numbers of the groups drawn, 0 to groups - 1, and returns the same number of figures each time, as many as intervals
// come back. A figure that is NaN in a draw is left out of its quantiles. Both ends are NaN for fewer than two groups and for a figure
// that is NaN in every draw. Throws std::logic_error for no draws.
std::vector<Interval> bootstrap_intervals(std::size_t groups, std::size_t draws, std::uint64_t seed,
                                          const std::function<std::vector<double>(std::span<const std::size_t>)>& figures);

}  // namespace slipbench
