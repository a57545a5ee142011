// What a scene may say of a grasp: the keys `grip`, `box` and `scatter`, and the named protocols.
#pragma once

#include <vector>

#include "sim/core/parameters.h"
#include "sim/scene/catalogues.h"

namespace slipbench {

// The three entries, by the name of their key.
const std::vector<Entry>& grasp_catalogue();

// The protocols that grip.protocol may name. What a protocol gives are defaults: a scene's own values replace them.
const std::vector<Protocol>& protocol_catalogue();

}  // namespace slipbench
