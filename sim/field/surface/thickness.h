// How thick a touched shape is.
#pragma once

#include "sim/field/surface/surface.h"

namespace slipbench {

// The least extent of the shape along any line through its middle [m]; infinite for a plane, and for a mesh, whose grid does not know it.
[[nodiscard]] double thickness_of(const Surface& surface);

}  // namespace slipbench
