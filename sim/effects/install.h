// Installs the effects of a scene on a field.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/parameters.h"

namespace slipbench {

// Installs the effects that a scene names, in its order, on a field of `layout` against `surface`.
// `seed` and `trial` key their random streams. Every name must be in the catalogue, with all its
// parameters. Throws SceneValueError if an effect does not fit the field.
FieldEffects install_effects(const std::vector<Named>& effects, const PadLayout& layout, const Surface& surface,
                             std::uint64_t seed, std::uint64_t trial);

// Returns the longest step [s] that all of them resolve when pad and surface move at up to `speed`
// [m/s].
double longest_step(const FieldEffects& effects, double speed);

}  // namespace slipbench
