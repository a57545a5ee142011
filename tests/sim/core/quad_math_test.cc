#include "sim/core/quad_math.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "sim/core/random.h"

namespace slipbench {
namespace {

TEST(QuadMath, EveryLaneHasTheBitsOfTheFunctionOfOne) {
  RandomStream stream(1, 0, "numbers");
  for (int trial = 0; trial < 100'000; ++trial) {
    Quad x;
    for (std::size_t lane = 0; lane < quad; ++lane) x[lane] = std::ldexp(stream.uniform(-1.0, 1.0), trial % 60 - 50);
    const Quad above = 1.0 + x * x, exponential = exp_of(x), logarithm = log_of(above);
    for (std::size_t lane = 0; lane < quad; ++lane) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(exponential[lane]), std::bit_cast<std::uint64_t>(std::exp(x[lane]))) << x[lane];
      ASSERT_EQ(std::bit_cast<std::uint64_t>(logarithm[lane]), std::bit_cast<std::uint64_t>(std::log(above[lane])))
          << above[lane];
    }
  }
}

}  // namespace
}  // namespace slipbench
