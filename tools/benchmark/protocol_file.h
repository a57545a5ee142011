// Reads the data file of a protocol, tools/benchmark/NAME.yaml, as README.md describes it.
#pragma once

#include <string>

#include "sim/scene/parser.h"
#include "tools/benchmark/protocol.h"

namespace slipbench::benchmark {

// Returns the protocol `name` that `file` describes. Throws InputError at the node that does not
// fit.
Protocol read_protocol(const std::string& name, const SceneFile& file);

}  // namespace slipbench::benchmark
