// The field of a pad on one touched geom.
#pragma once

#include <string>

#include "sim/api/pad_layout.h"
#include "sim/contact/field.h"
#include "sim/contact/surface/surface.h"
#include "sim/mujoco/pads/pad_config.h"
#include "sim/mujoco/releases/mujoco_library.h"

namespace slipbench {

// Returns the geom's name, or its number if it has none.
[[nodiscard]] std::string name_of_geom(ModelView model, int geom);

// Returns a layout without dashpots, which the instance computes itself: it knows the velocities,
// which a field would have to estimate.
[[nodiscard]] PadLayout without_dashpots(PadLayout layout);

// Returns the field of a pad's elements on the surface of `geom`. Throws InputError if an effect
// does not fit the pad, the surface or the solver.
[[nodiscard]] Field make_pad_field(ModelView model, const PadConfig& config, const PadLayout& layout, int geom,
                                   const Surface& surface);

// Returns a surface of the same kind as the geom's, as far as effects distinguish kinds and the
// size of a field's state depends on it. `geom_type`: mjtGeom.
[[nodiscard]] Surface kind_of_surface(int geom_type);

}  // namespace slipbench
