// A written detector against libtorch.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "tools/program/train/network/network.h"

namespace slipbench::train {

// Runs the ONNX file at `path` as a loop would, on the scaled frames of one sequence, and compares what it says with the logits of its members,
// or the mean of their probabilities: 1e-5, of the greater of 1 and the value. Throws std::logic_error where it says something else, InputError as
// network::load_engine().
void check_engine(const std::string& path, std::span<const std::unique_ptr<Network>> members, const FrameSequence& sequence);

}  // namespace slipbench::train
