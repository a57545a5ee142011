// From a frame of the PapillArray to what is encoded: a level for each pillar, and a context.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "detectors/hd/model.h"

namespace slipbench::hd {

// What a classifier sees of one frame.
struct Frame {
  std::array<std::uint8_t, pillar_count> level{};  // 0 to 20, of |tangential displacement| / |displacement|
  std::uint8_t context = 0;                        // 0 to 3, of the compression of the centre pillar

  bool operator==(const Frame&) const = default;
};

// How displacements become levels.
enum class Quantiser : std::uint8_t {
  fixed_point,  // as the published hardware: 1/8 mm, ratio in Q1.7, its table of levels. What the RTL computes
  exact,        // as the paper says: 1/8 mm, exact ratio, the nearest of 0, 0.05, ..., 1
  unrounded,    // exact ratio of the displacements as they are: shows what rounding to 1/8 mm costs
};

// A displacement in Q13.3 mm: 1/8 mm units, -32,768 to 32,767, x and y tangential, z into the sensor.
using FixedVector = std::array<std::int16_t, 3>;
using FixedFrame = std::array<FixedVector, pillar_count>;

// `displacement` [9][3] in m, in C order, to Q13.3 mm; halves go away from zero, as MATLAB's round has it.
// Throws InputError for NaN, infinity and whatever leaves Q13.3 (beyond 4.096 m): names pillar and axis. Nothing is clamped.
FixedFrame to_fixed(std::span<const float> displacement);

// Ratio |(x, y)| / |(x, y, z)| in Q1.7, 0 to 128: floor(sqrt(floor(2^14 (x^2 + y^2) / (x^2 + y^2 + z^2)))), all in integers (the squares
// are Q26.6, the quotient Q2.14). Equal to floor(128 ratio). 0 for no displacement at all.
std::uint8_t ratio_code(const FixedVector& displacement);

// The level of a code: how many levels start at or below it, less one. Codes above 128 are level 20, as in the published hardware.
std::uint8_t level_of_code(std::uint8_t code);

// The context of a compression of the centre pillar in 1/8 mm: up to 6, 8, 9, and above.
std::uint8_t context_of(std::int16_t compression);

// Levels and context of a frame as the RTL computes them.
Frame quantise(const FixedFrame& displacement);

// Levels and context of `displacement` [9][3] in m. Throws as to_fixed() does.
Frame quantise(std::span<const float> displacement, Quantiser quantiser);

}  // namespace slipbench::hd
