// From the effects that a scene names to those of a field.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/core/pad_layout.h"
#include "sim/core/parameters.h"
#include "sim/field/effect.h"
#include "sim/field/surface/surface.h"

namespace slipbench {

// The effects that a scene names, installed in its order on a field of `layout` against `surface`; `seed` and `trial` key their random
// streams. Throws SceneValueError when one does not fit the field. Every name must be in the catalogue, with all its parameters.
FieldEffects install_effects(const std::vector<Named>& effects, const PadLayout& layout, const Surface& surface,
                             std::uint64_t seed, std::uint64_t trial);

// The longest step [s] that all of them resolve when pad and surface move at up to `speed` [m/s].
double longest_step(const FieldEffects& effects, double speed);

}  // namespace slipbench
