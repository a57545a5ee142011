// What the library with libtorch exports.
#pragma once

#include "tools/program/learn/network.h"

namespace slipbench::learn {

inline constexpr const char* make_symbol = "slipbench_make_network";

// The caller owns the network.
using MakeNetwork = Network*(const NetworkShape& shape, std::uint64_t seed);

}  // namespace slipbench::learn
