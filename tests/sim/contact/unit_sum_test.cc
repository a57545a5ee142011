// Sums of a unit's columns, several at a time, against sums column by column: bit-identical.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "sim/contact/kernel.h"
#include "sim/core/random.h"

namespace slipbench::testing_field::unit_sum_test {
namespace {

using kernel::UnitSum;

TEST(UnitSum, EveryColumnIsAddedUpInTheOrderOfTheElements) {
  constexpr std::size_t entries = 40;
  RandomStream random(1, 0, "unit sum");
  std::vector<std::vector<double>> columns(UnitSum::vector_columns + 4, std::vector<double>(entries));
  for (std::vector<double>& column : columns) {
    // Magnitudes so different that another order gives another sum, with some zeros of both signs.
    for (double& entry : column) entry = random.normal() * std::pow(10.0, random.uniform(-6.0, 6.0));
    for (std::size_t k = 0; k < 4; ++k) column[random.integer(entries)] = k % 2 == 0 ? -0.0 : 0.0;
  }
  std::vector<double>& mode = columns.back();
  for (double& entry : mode) entry = static_cast<double>(random.integer(3));
  UnitSum::Summed summed{};
  for (std::size_t v = 0; v < UnitSum::vector_columns; ++v) summed.vectors[v] = columns[v].data();
  const double* const path = summed.path = columns[UnitSum::vector_columns].data();
  const double* const limit = summed.limit = columns[UnitSum::vector_columns + 1].data();
  const double* const f_normal = summed.f_normal = columns[UnitSum::vector_columns + 2].data();
  summed.mode = mode.data();
  std::fill_n(columns[0].begin(), 3, -0.0);  // their sum alone is -0

  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  for (std::size_t first = 0; first < 4; ++first) {
    for (std::size_t count = 1; count <= 13; ++count) {
      const UnitSum sum = kernel::sum_unit(summed, first, count);
      for (std::size_t v = 0; v < UnitSum::vector_columns; ++v) {
        double expected = columns[v][first];
        for (std::size_t i = first + 1; i < first + count; ++i) expected += columns[v][i];
        EXPECT_EQ(bits(sum.vectors[v]), bits(expected)) << "column " << v << ", " << count << " from " << first;
      }
      double slipped = 0.0, reach = 0.0, pressed = 0.0, touching = 0.0, slipping = 0.0;
      for (std::size_t i = first; i < first + count; ++i) {
        slipped += path[i];
        reach += limit[i];
        pressed += std::max(0.0, f_normal[i]);
        touching += mode[i] > 0.0 ? 1.0 : 0.0;
        slipping += mode[i] > 1.0 ? 1.0 : 0.0;
      }
      EXPECT_EQ(bits(sum.path), bits(slipped));
      EXPECT_EQ(bits(sum.limit), bits(reach));
      EXPECT_EQ(bits(sum.normal_force), bits(pressed));
      EXPECT_EQ(sum.touching, touching);
      EXPECT_EQ(sum.slipping, slipping);
    }
  }
}

}  // namespace
}  // namespace slipbench::testing_field::unit_sum_test
