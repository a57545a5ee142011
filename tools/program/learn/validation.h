// Judging a network on recordings that it has not learnt from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tools/program/learn/network.h"

namespace slipbench::learn {

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

struct Example {
  FrameSequence frames;
  std::size_t group = 0;  // what kind of recording it is, for its user to tell
};

// Who learns and who judges: the number of its fold for each of `groups`. Each group is shuffled by RandomStream(seed, 0, "folds") and dealt
// out in turn, so that all folds have as many of each, to within one. Throws std::invalid_argument for fewer than two folds.
std::vector<std::size_t> folds(std::span<const std::size_t> groups, std::size_t count, std::uint64_t seed);

struct Validation {
  NetworkShape shape;
  TrainingOptions training;
  std::function<bool(std::size_t group)> learns = [](std::size_t) { return true; };  // whether it learns from a group at all
};

// One network: learns from the examples outside `fold`, standardised by them alone, and calls the frames of those in it. Returns counts by
// group [greatest group + 1]. Throws InputError as make_network, std::invalid_argument as Network::train.
std::vector<Counts> judge_fold(std::span<const Example> examples, std::span<const std::size_t> fold_of, std::size_t fold,
                               const Validation& validation);

}  // namespace slipbench::learn
