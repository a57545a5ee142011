// Entries of columns that are worked on at once, and what the kernel's files share.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#include <Eigen/Core>

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

// The entries of a rotation, for loops that are to find them in registers.
struct Rotation {
  double r00, r01, r02, r10, r11, r12, r20, r21, r22;
};

SLIPBENCH_INLINE Rotation entries_of(const Eigen::Matrix3d& r) {
  return {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)};
}

}  // namespace slipbench::kernel
