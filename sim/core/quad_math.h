// Exponential and logarithm of four numbers, lane by lane by the scalar functions: a number has the
// same result in any lane and by itself, on every architecture and with any mathematical library.
#pragma once

#include <cmath>
#include <cstdint>

#include "sim/core/vectorise.h"

namespace slipbench {

using QuadBits __attribute__((vector_size(quad * sizeof(std::uint64_t)))) = std::uint64_t;

SLIPBENCH_INLINE Quad exp_of(const Quad& x) { return Quad{std::exp(x[0]), std::exp(x[1]), std::exp(x[2]), std::exp(x[3])}; }
SLIPBENCH_INLINE Quad log_of(const Quad& x) { return Quad{std::log(x[0]), std::log(x[1]), std::log(x[2]), std::log(x[3])}; }

}  // namespace slipbench
