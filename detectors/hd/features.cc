#include "detectors/hd/features.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include "sim/core/error.h"
#include "sim/core/math/decade.h"
#include "sim/core/quantity.h"

namespace slipbench::hd {
namespace {

constexpr double units_per_metre = 8000.0;  // 1/8 mm

// The code at which each level starts, from the table of the published hardware; steps are not
// exactly 0.05 * 128 = 6.4.
constexpr std::array<std::uint8_t, level_count> level_starts{0,  4,  8,  16, 24, 32,  36,  40,  48,  56, 64,
                                                             68, 72, 80, 88, 96, 100, 104, 112, 120, 128};

[[noreturn]] void refuse(std::size_t value, const std::string& what) {
  throw InputError("displacement of pillar " + std::to_string(value / 3) + " along " + "xyz"[value % 3] + ": " + what);
}

// Returns the floor of the square root, bit by bit, as the RTL computes it. `value` <= 2^14.
std::uint32_t integer_sqrt(std::uint32_t value) {
  std::uint32_t root = 0;
  for (std::uint32_t bit = 128; bit != 0; bit /= 2) {
    if ((root + bit) * (root + bit) <= value) root += bit;
  }
  return root;
}

// Returns the level nearest to sqrt(t2 / d2), the upper one halfway: level l begins at the ratio (2
// l - 1) / 40. Exact for integers up to 2^32; 0 for d2 = 0.
template <class Number>
std::uint8_t nearest_level(Number t2, Number d2) {
  std::uint8_t level = 0;
  for (unsigned next = 1; next < level_count; ++next) {
    const unsigned edge = 2 * next - 1;
    if (d2 > Number{0} && Number{1600} * t2 >= static_cast<Number>(edge * edge) * d2) level = static_cast<std::uint8_t>(next);
  }
  return level;
}

struct Squares {
  std::uint64_t tangential, total;
};

Squares squares(const FixedVector& d) {
  const auto square = [](std::int64_t x) { return static_cast<std::uint64_t>(x * x); };
  const std::uint64_t tangential = square(d[0]) + square(d[1]);
  return {tangential, tangential + square(d[2])};
}

void check_size(std::span<const float> displacement) {
  if (displacement.size() != 3 * pillar_count) {
    throw std::out_of_range("hd features: " + std::to_string(displacement.size()) + " displacements, not 27");
  }
}

}  // namespace

FixedFrame to_fixed(std::span<const float> displacement) {
  check_size(displacement);
  FixedFrame fixed{};
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const double metres = displacement[i];
    if (!std::isfinite(metres)) refuse(i, std::isnan(metres) ? "NaN" : "infinite");
    const double units = std::round(metres * units_per_metre);
    using Limits = std::numeric_limits<std::int16_t>;
    if (units < Limits::min() || units > Limits::max()) {
      refuse(i, format_number(rounded_to_digits(metres, std::numeric_limits<float>::max_digits10)) +
                    " m; allowed: -4.096 to 4.095875 m, the range of Q13.3 mm");
    }
    fixed[i / 3][i % 3] = static_cast<std::int16_t>(units);
  }
  return fixed;
}

std::uint8_t ratio_code(const FixedVector& displacement) {
  const auto [tangential, total] = squares(displacement);
  return total == 0 ? std::uint8_t{0}
                    : static_cast<std::uint8_t>(integer_sqrt(static_cast<std::uint32_t>((tangential << 14) / total)));
}

std::uint8_t level_of_code(std::uint8_t code) {
  return static_cast<std::uint8_t>(std::ranges::upper_bound(level_starts, code) - level_starts.begin() - 1);
}

std::uint8_t context_of(std::int16_t compression) {
  constexpr std::array<std::int16_t, context_count - 1> last{6, 8, 9};  // 0.75, 1, 1.125 mm
  return static_cast<std::uint8_t>(std::ranges::lower_bound(last, compression) - last.begin());
}

Frame quantise(const FixedFrame& displacement) {
  Frame frame;
  for (std::size_t p = 0; p < pillar_count; ++p) frame.level[p] = level_of_code(ratio_code(displacement[p]));
  frame.context = context_of(displacement[centre_pillar][2]);
  return frame;
}

Frame quantise(std::span<const float> displacement, Quantiser quantiser) {
  const FixedFrame fixed = to_fixed(displacement);
  Frame frame = quantise(fixed);
  if (quantiser == Quantiser::fixed_point) return frame;
  for (std::size_t p = 0; p < pillar_count; ++p) {
    if (quantiser == Quantiser::exact) {
      const auto [tangential, total] = squares(fixed[p]);
      frame.level[p] = nearest_level(tangential, total);
    } else {
      const double x = displacement[3 * p], y = displacement[3 * p + 1], z = displacement[3 * p + 2];
      frame.level[p] = nearest_level(x * x + y * y, x * x + y * y + z * z);
    }
  }
  return frame;
}

}  // namespace slipbench::hd
