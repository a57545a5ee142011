// Quantises a frame of the PapillArray: a level for each pillar, and a context.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "detectors/hd/model.h"

namespace slipbench::hd {

// Input of a classifier for one frame.
struct Frame {
  std::array<std::uint8_t, pillar_count> level{};  // 0 to 20, of |tangential displacement| / |displacement|
  std::uint8_t context = 0;                        // 0 to 3, of the compression of the centre pillar

  bool operator==(const Frame&) const = default;
};

// Conversion of displacements to levels.
enum class Quantiser : std::uint8_t {
  fixed_point,  // as the published hardware: 1/8 mm, ratio in Q1.7, table of levels; the RTL computes this
  exact,        // as the paper states: 1/8 mm, exact ratio, the nearest of 0, 0.05, ..., 1
  unrounded,    // exact ratio of the unrounded displacements, to show the effect of rounding to 1/8 mm
};

// A displacement in Q13.3 mm: 1/8 mm units, -32,768 to 32,767, x and y tangential, z into the
// sensor.
using FixedVector = std::array<std::int16_t, 3>;
using FixedFrame = std::array<FixedVector, pillar_count>;

// Converts `displacement` [9][3] in m, in C order, to Q13.3 mm; halves are rounded away from zero,
// like MATLAB's round. Throws InputError, naming pillar and axis, for NaN, infinity and values
// outside Q13.3 (beyond 4.096 m). Nothing is clamped.
FixedFrame to_fixed(std::span<const float> displacement);

// Ratio |(x, y)| / |(x, y, z)| in Q1.7, 0 to 128: floor(sqrt(floor(2^14 (x^2 + y^2) / (x^2 + y^2 +
// z^2)))), all in integers (the squares are Q26.6, the quotient Q2.14). Equal to floor(128 ratio).
// 0 for no displacement at all.
std::uint8_t ratio_code(const FixedVector& displacement);

// Returns the level of a code: the number of levels that start at or below it, minus one. Codes
// above 128 give level 20, as in the published hardware.
std::uint8_t level_of_code(std::uint8_t code);

// Returns the context of a compression of the centre pillar in 1/8 mm: up to 6, 8, 9, and above.
std::uint8_t context_of(std::int16_t compression);

// Levels and context of a frame as the RTL computes them.
Frame quantise(const FixedFrame& displacement);

// Levels and context of `displacement` [9][3] in m. Throws as to_fixed() does.
Frame quantise(std::span<const float> displacement, Quantiser quantiser);

}  // namespace slipbench::hd
