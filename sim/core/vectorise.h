// Macros and types for loops that become vector code; names that differ between architectures.
#pragma once

#include <cstddef>
#include <cstring>

// Compiles a function for x86-64-v3 and for any x86-64; the loader picks one by the CPU. Sanitizers
// crash in the loader's early calls, and other compilers lack the attribute: they get the portable
// version, which computes the same bits.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__OPTIMIZE__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SLIPBENCH_DISPATCHES
#define SLIPBENCH_DISPATCHED __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SLIPBENCH_DISPATCHED
#endif
// For a loop with independent iterations.
#if defined(__clang__)
#define SLIPBENCH_VECTORISE _Pragma("clang loop vectorize(assume_safety)")
#else
#define SLIPBENCH_VECTORISE _Pragma("GCC ivdep")
#endif
#define SLIPBENCH_INLINE inline __attribute__((always_inline))
// The same for a lambda, after its parameters.
#define SLIPBENCH_INLINE_BODY __attribute__((always_inline))

namespace slipbench {

// Four numbers processed at once, for loops that compilers do not vectorise.
inline constexpr std::size_t quad = 4;
using Quad __attribute__((vector_size(quad * sizeof(double)))) = double;
using QuadFloat __attribute__((vector_size(quad * sizeof(float)))) = float;

template <class Vector, class Number>
SLIPBENCH_INLINE Vector vector_at(const Number* from) {
  Vector values;
  std::memcpy(&values, from, sizeof values);
  return values;
}

template <class Vector, class Number>
SLIPBENCH_INLINE void put_vector(Number* to, const Vector& values) {
  std::memcpy(to, &values, sizeof values);
}

// Element by element: GCC 12 compiles __builtin_convertvector to two halves and a dependence on the
// previous step.
SLIPBENCH_INLINE Quad widened(const float* from) {
  const auto values = vector_at<QuadFloat>(from);
  return Quad{values[0], values[1], values[2], values[3]};
}

SLIPBENCH_INLINE bool any(const decltype(Quad{} == Quad{}) & mask) {
  const auto halves = __builtin_shufflevector(mask, mask, 0, 1) | __builtin_shufflevector(mask, mask, 2, 3);
  return (halves[0] | halves[1]) != 0;
}

}  // namespace slipbench

// The name of SLEEF's deterministic function of two numbers [shibata2020] that runs on every
// processor of the architecture. All architectures get the same bits.
#if defined(__x86_64__)
#define SLIPBENCH_SLEEF(function) Sleef_cinz_##function##sse2
#elif defined(__aarch64__)
#define SLIPBENCH_SLEEF(function) Sleef_cinz_##function##advsimdnofma
#else
#error "slipbench supports x86-64 and arm64"
#endif
