// How a run ends that has gone wrong.
#pragma once

#include "sim/core/error.h"

namespace slipbench {

// The scene's time step is the first to look at. Whoever has read the scene adds where it stands.
class WrongRun : public InputError {
 public:
  using InputError::InputError;
};

}  // namespace slipbench
