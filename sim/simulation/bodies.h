// The shapes that a scene's own bodies may have.
#pragma once

#include <vector>

#include "sim/core/parameters.h"

namespace slipbench {

// All shapes, one line each: what `bodies` of a scene may name and `describe` prints. sim/mujoco builds them.
const std::vector<Entry>& body_catalogue();

}  // namespace slipbench
