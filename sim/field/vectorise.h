// Entries of columns that are worked on at once.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#include "sim/core/vectorise.h"
#include "sim/field/kernel.h"

namespace slipbench::kernel {

// As many entries of a column as are worked on at once: for loops that would not become vector code by themselves, and for sums whose
// order does not depend on how they do.
using Lanes __attribute__((vector_size(lanes * sizeof(double)))) = double;
using Mask = decltype(Lanes{} == Lanes{});

SLIPBENCH_INLINE Lanes lanes_at(const double* from) {
  Lanes values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

SLIPBENCH_INLINE void put_lanes(double* to, const Lanes& values) { std::memcpy(to, &values, sizeof values); }

SLIPBENCH_INLINE Lanes root(const Lanes& values) {
  Lanes roots;
  for (std::size_t lane = 0; lane < lanes; ++lane) roots[lane] = std::sqrt(values[lane]);
  return roots;
}

SLIPBENCH_INLINE bool any(const Mask& mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

}  // namespace slipbench::kernel
