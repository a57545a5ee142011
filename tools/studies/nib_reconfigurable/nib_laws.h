// The friction laws that the nib pad's slip tests are repeated with.
#pragma once

#include <vector>

#include "tools/studies/nib_reconfigurable/nib_bench.h"

namespace slipbench::reproduce {

// A change of the scene's friction, of which everything else stays.
struct FrictionLaw {
  const char* name;
  const char* text;
  SceneChange change;
};

// The scene's own law first.
const std::vector<FrictionLaw>& friction_laws();

}  // namespace slipbench::reproduce
