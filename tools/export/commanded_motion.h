// How a trial's pad was told to move.
#pragma once

#include <cstddef>

#include "tools/dataset/reader.h"

namespace slipbench {

struct CommandedMotion {
  double speed = 0.0;     // m/s, motion.speed
  double rotation = 0.0;  // rad/s, motion.rotation
};

// Takes the values from what was swept, else from the overrides and the scene that the dataset carries, else the motion's defaults.
// Throws InputError when the scene cannot be read or its motion has no such values.
CommandedMotion commanded_motion(const DatasetReader& reader, std::size_t trial);

}  // namespace slipbench
