// Frames of a sensor that a test makes up.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/core/detector.h"

namespace slipbench {

// Channels {units, 3}, as a PapillArray has them.
inline FrameSource vector_source(const std::vector<std::string>& channels, std::size_t units, double rate) {
  FrameSource source{"pad", "papillarray", rate, {}};
  for (const std::string& name : channels) source.channels.push_back({name, "", {units, 3}, {}});
  return source;
}

}  // namespace slipbench
