// Which trials of a sweep a shard has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/scene/parser.h"

namespace slipbench {

// Numbers of the trials of shard `number` (from 1 on) of `count`, ascending. Every machine computes the same from the scene and the seed:
// the first `trials` of the plan are ordered by what they cost, the costliest first, equal ones in an order drawn from the seed, and dealt out in
// turn. Cost: ticks times elements of the first draw of the trial's cell; equal for all where the sweep sets neither the duration, the step, the
// fidelity nor the sensors, and in a sweep of more than 10,000 cells. Throws InputError where there are fewer trials than shards.
std::vector<std::size_t> trials_of_shard(const TrialPlan& plan, std::size_t trials, std::uint64_t seed, std::size_t number,
                                         std::size_t count);

}  // namespace slipbench
