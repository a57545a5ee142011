// Judging a network on recordings that it has not learnt from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/program/train/network/network.h"

namespace slipbench::train {

// Frames by what is true and what was called.
struct Counts {
  std::uint64_t slip_called_slip = 0, slip_called_hold = 0, hold_called_slip = 0, hold_called_hold = 0;

  void add(bool slip, bool called);
  void add(const Counts& other);
  // Mean of the shares of slip and of hold that were called so; NaN where one does not occur.
  [[nodiscard]] double balanced_accuracy() const;
  // 2 P R/(P + R) of slip; NaN where nothing is and nothing was called slip.
  [[nodiscard]] double f1() const;
};

struct FoldExample {
  FrameSequence frames;
  std::size_t group = 0;  // what kind of recording it is, for its user to tell
};

// Who learns and who judges: the number of its fold for each of `groups`. Each group is shuffled by RandomStream(seed, 0, "folds") and dealt
// out in turn, so that all folds have as many of each, to within one. Throws std::invalid_argument for fewer than two folds.
std::vector<std::size_t> folds(std::span<const std::size_t> groups, std::size_t count, std::uint64_t seed);

struct Validation {
  NetworkShape shape;
  TrainingOptions training;
  double validated =
      0.0;  // share of the recordings learnt from that choose the best state instead, rounded down; 0: the last state is kept
  std::function<bool(std::size_t group)> learns = [](std::size_t) { return true; };  // whether it learns from a group at all
  Scaling scaling = Scaling::standard;  // of the frames, by those that it learns from
};

// Of each example, as Network::logits gives them.
using Logits = std::vector<std::vector<float>>;

// One network: learns from the examples outside `fold`, scaled by them alone, and answers those in it; examples outside have no logits. Throws
// InputError as make_network, std::invalid_argument as Network::train.
Logits logits_in_fold(std::span<const FoldExample> examples, std::span<const std::size_t> fold_of, std::size_t fold,
                      const Validation& validation);

// What each frame of each example is called: 1, slip; `masked`, it is not judged.
using Calls = std::vector<std::vector<std::uint8_t>>;

// The same of two classes, 1: slip, as calls: slip where that is the more probable class. The first history_of() - 1 frames of an example are
// not judged; examples outside `fold` have no calls.
Calls called_in_fold(std::span<const FoldExample> examples, std::span<const std::size_t> fold_of, std::size_t fold,
                     const Validation& validation);

// Judged frames of two classes whose label is not masked, by group [greatest group + 1].
std::vector<Counts> counts_of(std::span<const FoldExample> examples, const Calls& calls);

}  // namespace slipbench::train
