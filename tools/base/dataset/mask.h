// The split of a dataset into training, validation and test trials.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace slipbench {

// How a scene wants its trials split.
struct SplitRule {
  std::string by;                // "material", "object", "speed": trials alike in it stay together; "trial": each goes by itself
  std::array<double, 3> shares;  // for training, validation and test, of the groups; 1 in all
  std::string said_by = "as the scene says";  // the last words of Masks::rule
};

struct Masks {
  std::string split_by;  // SplitRule::by; without a rule "material", or "trial" where there is only one material
  std::string rule;      // the same as a sentence
  std::vector<std::size_t> train;
  std::vector<std::size_t> valid;
  std::vector<std::size_t> test;
};

// Splits trials (number, group) so that no group is in two of the parts. Without a rule the groups are materials, or single
// trials where all share one material, and 70 % of them are for training, 15 % for validation and 15 % for the test. A part that
// has a share gets at least one group, the test first, as long as one is left for training. Who goes where is shuffled by
// RandomStream(seed, 0, "mask"). Each part ascends.
Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed,
                   const std::optional<SplitRule>& rule = {});

}  // namespace slipbench
