// Finds the effects of a scene in the catalogue and installs them on a field.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "sim/api/effect.h"
#include "sim/api/pad_layout.h"
#include "sim/contact/surface/surface.h"
#include "sim/core/parameters.h"
#include "sim/effects/effect_catalogue.h"

namespace slipbench {

// Returns the catalogue's entry of the effect `name`, which must be in the catalogue.
const EffectKind& effect_kind(std::string_view name);

// Installs the effects that a scene names, in its order, on a field of `layout` against `surface`.
// `seed` and `trial` key their random streams. Every name must be in the catalogue, with all its
// parameters. Throws SceneValueError if an effect does not fit the field.
FieldEffects install_effects(const std::vector<Named>& effects, const PadLayout& layout, const Surface& surface,
                             std::uint64_t seed, std::uint64_t trial);

// Returns the longest step [s] that all of them resolve when pad and surface move at up to `speed`
// [m/s].
double longest_step(const FieldEffects& effects, double speed);

}  // namespace slipbench
