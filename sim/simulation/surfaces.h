// The shapes that a scene may press on, and where they stand.
#pragma once

#include <vector>

#include "sim/core/parameters.h"
#include "sim/core/pose.h"
#include "sim/field/surface/surface.h"

namespace slipbench {

// A shape in the world: its highest point or line is at z = 0 unless its position says otherwise.
struct PlacedSurface {
  Surface shape;
  Pose pose;  // of the surface frame in the world
};

struct SurfaceKind {
  Entry about;
  PlacedSurface (*create)(const Parameters& parameters);
};

// All shapes, one line each.
const std::vector<SurfaceKind>& surface_catalogue();

}  // namespace slipbench
