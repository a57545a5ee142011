// The trial of a sweep that an environment's episode runs.
#pragma once

#include <cstddef>
#include <cstdint>

namespace slipbench {

// Returns the trial of episode number `episode` of `seed` in a plan of `cells` grid cells with
// `draws` trials each. Successive episodes cycle through all cells in an order in which neighbours
// are far apart, so that a few episodes vary every axis. The first cell depends on the seed:
// successive seeds begin in successive cells of that order, so that the environments of a vector
// differ, and each block of `cells` seeds is shifted at random, so that multiples of `cells` differ
// too.
std::size_t trial_of_episode(std::size_t cells, std::size_t draws, std::uint64_t seed, std::uint64_t episode);

}  // namespace slipbench
