// What the library with OpenVINO exports.
#pragma once

#include <string>

#include "detectors/network/engine.h"

namespace slipbench::network {

inline constexpr const char* load_symbol = "slipbench_load_engine";

// load_engine(); the caller owns the engine.
using LoadEngine = Engine*(const std::string& path);

}  // namespace slipbench::network
