// Thickness of a touched shape.
#pragma once

#include "sim/contact/surface/surface.h"

namespace slipbench {

// Returns the least extent of the shape along any line through its centre [m]; infinite for a
// plane, and for a mesh, whose grid does not know it.
[[nodiscard]] double thickness_of(const Surface& surface);

// Returns the radius of a ball about the origin of S that contains the surface [m]; infinite for a
// plane and for a grid, which rounds what it contains.
double ball_around(const Surface& surface);

}  // namespace slipbench
