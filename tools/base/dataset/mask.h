// The split of a dataset into training, validation and test trials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace slipbench {

struct Masks {
  std::string split_by;  // "material", or "trial" where there is only one material
  std::vector<std::size_t> train;
  std::vector<std::size_t> valid;
  std::vector<std::size_t> test;
};

// Splits trials (number, material) by material, so that no material is in two of the parts; where all trials share one, by trial.
// Either way 70 % of the materials or trials are for training, 15 % for validation and 15 % for the test, at least one each where
// there are three; who goes where is shuffled by RandomStream(seed, 0, "mask"). Each part ascends.
Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed);

}  // namespace slipbench
