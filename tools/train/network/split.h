// Divides examples into training, validation and test.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/choice.h"
#include "tools/train/network/examples.h"

namespace slipbench::train {

// Property whose groups are never in both training and test.
enum class Split {
  trial,
  material,
  object,
  speed,  // octaves of the commanded speed
};
inline constexpr std::array split_words{Choice<Split>{"trial", Split::trial}, Choice<Split>{"material", Split::material},
                                        Choice<Split>{"object", Split::object}, Choice<Split>{"speed", Split::speed}};

enum class Part : std::uint8_t { learns, validates, judges, left_out };

// The part of each example. A group is an experiment (trials with equal Example::twin), a material,
// an object or an octave of speed; either all or none of its examples are for the test. Groups are
// shuffled by RandomStream(seed, 0, "split"), and `held_out` of them, rounded up, are for the test.
// A fifth of the other trials, rounded up, is for validation (a fifth of the groups if five or more
// remain). Trials with other classes, and with and without contact, are divided separately. A
// turned copy whose trial is not for training is left out.
// Examples with a part in their dataset's own split keep it: train learns, valid validates, test
// judges, none is left out. If no such example has the part valid, a fifth of the experiments of
// train validates.
// Throws InputError if a part would be empty, or the property for the split is unknown.
std::vector<Part> split_examples(std::span<const Example> examples, Split split, double held_out, std::uint64_t seed);

}  // namespace slipbench::train
