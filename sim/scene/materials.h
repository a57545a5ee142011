// The materials that a surface may be made of.
#pragma once

#include <vector>

#include "sim/scene/catalogues.h"

namespace slipbench {

// Friction of the pads' silicone on each material, dry unless the name says otherwise.
std::vector<Material> material_table();

}  // namespace slipbench
