// Who trains and who is tested: a bootstrap within conditions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/program/train/sequences.h"

namespace slipbench {

// Draws made of a dataset: number 0 is for choosing parameters, the others make the figures (paper, section IV.A).
inline constexpr std::size_t draw_count = 6;

// The condition of a sequence: the band of its commanded compression (up to 0.75, 1, 1.125 mm and above, as the paper's contexts)
// and the octave of its commanded speed (nearest power of two in mm/s; that of a corner pillar where the turn is the faster). Equal
// numbers are equal conditions.
std::size_t condition_of(const CommandedMotion& motion);

// How often each item trains in a draw; those that never do are its test.
struct BootstrapDraw {
  std::vector<std::uint32_t> times;

  [[nodiscard]] bool tests(std::size_t item) const { return times[item] == 0; }
  [[nodiscard]] std::size_t training_size() const;  // items, repeats counted
  [[nodiscard]] std::size_t distinct() const;       // items that train at all
};

// Conditional bootstrap: of each condition as many items are drawn as it has, with replacement, by RandomStream(seed, draw,
// "bootstrap"). `conditions`: one an item. Of n items of a condition (1 - 1/n)^n are left for the test on average: 35 % of 10.
BootstrapDraw bootstrap(std::span<const std::size_t> conditions, std::uint64_t seed, std::size_t draw);

}  // namespace slipbench
