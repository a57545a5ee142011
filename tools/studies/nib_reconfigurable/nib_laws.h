// The friction laws that the nib pad's slip tests are repeated with.
#pragma once

#include <functional>
#include <vector>

#include "sim/scene/scene.h"

namespace slipbench::reproduce {

// A change of the scene's friction, of which everything else stays.
struct FrictionLaw {
  const char* name;
  const char* text;
  std::function<void(Scene&)> change;
};

// The scene's own law first.
const std::vector<FrictionLaw>& friction_laws();

}  // namespace slipbench::reproduce
