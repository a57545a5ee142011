// Exponential and logarithm of four numbers at once: musl's, which the program links, to the bit. Its steps in its order, on its tables.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/core/vectorise.h"

namespace slipbench {

// exp_data: 1/(ln 2/128), shift, -ln 2/128 in two parts, 4 coefficients, 6 of exp2; 128 pairs of a tail and the bits of 2^(i/128), less i << 45.
extern "C" const double musl_exp_data[14 + 2 * 128] __asm__("__exp_data");
// log_data: ln 2 in two parts, 5 coefficients, 11 next to 1; 128 pairs of 1/c and ln c, then of c in two parts.
extern "C" const double musl_log_data[18 + 4 * 128] __asm__("__log_data");

using QuadBits __attribute__((vector_size(quad * sizeof(std::uint64_t)))) = std::uint64_t;

// For |x| < 512.
SLIPBENCH_INLINE Quad exp_of(const Quad& x) {
  const double *const d = musl_exp_data, *const c = d + 4;
  const Quad shifted = d[0] * x + d[1], k = shifted - d[1], r = x + k * d[2] + k * d[3], r2 = r * r;
  const auto bits = reinterpret_cast<QuadBits>(shifted);
  Quad tail, power;
  for (std::size_t lane = 0; lane < quad; ++lane) {
    const double* const entry = d + 14 + 2 * (bits[lane] % 128);
    tail[lane] = entry[0], power[lane] = entry[1];
  }
  const auto scale = reinterpret_cast<Quad>(reinterpret_cast<QuadBits>(power) + (bits << 45));
  return scale + scale * (tail + r + r2 * (c[0] + r * c[1]) + r2 * r2 * (c[2] + r * c[3]));
}

// For finite x >= 1.
SLIPBENCH_INLINE Quad log_of(const Quad& x) {
  const double *const d = musl_log_data, *const a = d + 2, *const b = d + 7;
  const auto near = x < 1.0 + 0x1.09p-4;
  Quad result{};
  if (any(near)) {
    const Quad r = x - 1.0, r2 = r * r, r3 = r * r2, w = r * 0x1p27, high = r + w - w, square = high * high * b[0],
               sum = r + square;
    const Quad tail = r3 * (b[4] + r * b[5] + r2 * b[6] + r3 * (b[7] + r * b[8] + r2 * b[9] + r3 * b[10]));
    result = r3 * (b[1] + r * b[2] + r2 * b[3] + tail) + (r - sum + square + b[0] * (r - high) * (high + r)) + sum;
  }
  if (any(~near)) {
    const auto bits = reinterpret_cast<QuadBits>(x), beyond = bits - 0x3fe6000000000000;
    // At a power of two the last bits are a whole number.
    const Quad k = reinterpret_cast<Quad>(beyond >> 52 | 0x4330000000000000) - 0x1p52;
    Quad inverse, log, high, low;
    for (std::size_t lane = 0; lane < quad; ++lane) {
      const double* const entry = d + 18 + 2 * (beyond[lane] >> 45 & 127);
      inverse[lane] = entry[0], log[lane] = entry[1], high[lane] = entry[256], low[lane] = entry[257];
    }
    const Quad r = (reinterpret_cast<Quad>(bits - (beyond & 0xfff0000000000000)) - high - low) * inverse, r2 = r * r;
    const Quad w = k * d[0] + log, sum = w + r;
    const Quad far = w - sum + r + k * d[1] + r2 * a[0] + r * r2 * (a[1] + r * a[2] + r2 * (a[3] + r * a[4])) + sum;
    result = near ? result : far;
  }
  return result;
}

}  // namespace slipbench
