// The materials of surfaces.
#pragma once

#include <vector>

#include "sim/scene/catalogues.h"

namespace slipbench {

// Returns the friction of the pads' silicone on each material, dry unless the name says otherwise.
std::vector<Material> material_table();

}  // namespace slipbench
