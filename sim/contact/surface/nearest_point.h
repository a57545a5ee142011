// The result of a shape for one element or for a vector of elements.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>

#include "sim/core/vectorise.h"

namespace slipbench {

// Result of at() for one element, or for the elements of a vector (kernel::Lanes). nearest() has no
// branches on vectors, since the elements may be different cases, unless no element needs the
// branch; each case is computed in the order of the scalar branches.
template <class Real>
struct NearestPoint {
  Real gap, nx, ny, nz, faces;
};

template <class Real>
[[gnu::always_inline]] inline Real root_of(const Real& values) {
  if constexpr (std::is_same_v<Real, double>) {
    return std::sqrt(values);
  } else {
    Real roots;
    for (std::size_t lane = 0; lane < sizeof(Real) / sizeof(double); ++lane) roots[lane] = std::sqrt(values[lane]);
    return roots;
  }
}

// True if a condition holds for the element, or for any of several.
template <class Mask>
[[gnu::always_inline]] inline bool any_of(const Mask& mask) {
  if constexpr (std::is_same_v<Mask, bool> || std::is_same_v<Mask, int>) {
    return mask != 0;
  } else {
    return any(mask);
  }
}

}  // namespace slipbench
