// The offset and scale that frames are learnt with, and seen with in the loop (network::Input).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "tools/program/train/network/network.h"

namespace slipbench::train {

enum class Scaling {
  standard,  // mean 0 and standard deviation 1 of every feature
  common,    // likewise, with one mean and one deviation for all features
  range,     // 0 to 1, the least to the greatest value of every feature
};

// A feature x becomes (x - offset) scale. One for all, or one for each feature.
struct Scale {
  std::vector<double> offset, scale;
};

// That of the frames of these sequences. What never changes is only shifted. Throws std::invalid_argument of no frame.
Scale scale_of(std::span<const FrameSequence* const> sequences, std::size_t inputs, Scaling scaling);

// In float32, as network::Frames does it.
void apply(const Scale& scale, FrameSequence& sequence);

}  // namespace slipbench::train
