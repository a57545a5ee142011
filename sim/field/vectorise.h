// How loops over columns are compiled to vector code.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#include "sim/field/kernel.h"

// Each pass is compiled for x86-64-v3 and for any x86-64, and the loader picks one by the CPU it finds. Sanitizers do not survive the
// loader's early calls, and other compilers lack the attribute: they get the portable version, which computes the same bits.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__OPTIMIZE__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SLIPBENCH_DISPATCHED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SLIPBENCH_DISPATCHED
#endif
#if defined(__clang__)
#define SLIPBENCH_VECTORISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define SLIPBENCH_VECTORISE _Pragma("GCC ivdep")
#endif
#define SLIPBENCH_INLINE inline __attribute__((always_inline))

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
