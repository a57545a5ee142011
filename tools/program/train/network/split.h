// Which examples train, which validate and which judge.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "detectors/hd/words.h"
#include "tools/program/train/network/examples.h"

namespace slipbench::train {

// Groups that never appear in both training and test.
enum class Split {
  trial,
  material,
  object,
  speed,  // octaves of the commanded speed
};
inline constexpr std::array split_words{hd::Word<Split>{"trial", Split::trial}, hd::Word<Split>{"material", Split::material},
                                        hd::Word<Split>{"object", Split::object}, hd::Word<Split>{"speed", Split::speed}};

enum class Part : std::uint8_t { learns, validates, judges, left_out };

// The part of each example. All examples of a group, which is an experiment (trials whose Example::twin is equal), a material, an object or an
// octave of speed, judge or none does: groups are shuffled by RandomStream(seed, 0, "split"), and `held_out` of them, rounded up, judge. A fifth of the
// other trials, rounded up, validates (a fifth of the groups where there are five or more left). Trials with other classes, and with and without
// contact, are dealt out apart. A turned copy whose trial does not learn is left out. Examples with
// a part of their dataset's own split keep to it: train learns, valid validates, test judges, none
// is left out. Where no such example is of the part valid, a fifth of the experiments of train
// validates. Throws InputError where a part would be empty, or nothing is known to split by.
std::vector<Part> split_examples(std::span<const Example> examples, Split split, double held_out, std::uint64_t seed);

}  // namespace slipbench::train
