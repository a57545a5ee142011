#include "tools/base/dataset/mask.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "sim/core/random.h"

namespace slipbench {
namespace {

constexpr std::array<double, 3> usual_shares{0.70, 0.15, 0.15};

// `share` of `count` groups, rounded to the nearest, at least one where there is a share.
std::size_t part_of(std::size_t count, double share) {
  if (share == 0.0) return 0;
  constexpr double rounding = 1e-9;  // a half is a half, whatever 0.15 is as a double
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(share * static_cast<double>(count) + 0.5 + rounding)));
}

std::string rule_text(const std::optional<SplitRule>& rule, bool one_material) {
  if (!rule) {
    return one_material ? "70/15/15 % of the trials, shuffled by the seed, since all share one material"
                        : "70/15/15 % of the materials, shuffled by the seed; no material is in two parts";
  }
  const auto& [train, valid, test] = rule->shares;
  const std::string shares = fmt::format("{:.4g}/{:.4g}/{:.4g} % of the", 100.0 * train, 100.0 * valid, 100.0 * test);
  if (rule->by == "trial") return fmt::format("{} trials, shuffled by the seed, {}", shares, rule->said_by);
  return fmt::format("{} {}s, shuffled by the seed, {}; no {} is in two parts", shares, rule->by, rule->said_by, rule->by);
}

}  // namespace

Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed,
                   const std::optional<SplitRule>& rule) {
  std::map<std::string, std::vector<std::size_t>> by_name;
  for (const auto& [trial, name] : trials) by_name[name].push_back(trial);
  const bool one_material = by_name.size() <= 1;

  Masks masks;
  masks.split_by = rule ? rule->by : one_material ? "trial" : "material";
  masks.rule = rule_text(rule, one_material);
  std::vector<std::vector<std::size_t>> groups;
  if (masks.split_by == "trial") {
    for (const auto& [trial, name] : trials) groups.push_back({trial});
  } else {
    for (auto& [name, members] : by_name) groups.push_back(std::move(members));
  }

  RandomStream random(seed, 0, "mask");
  for (std::size_t left = groups.size(); left > 1; --left) {  // Fisher-Yates
    std::swap(groups[left - 1], groups[static_cast<std::size_t>(random.integer(left))]);
  }
  const std::array<double, 3>& shares = rule ? rule->shares : usual_shares;
  const std::size_t spare = groups.empty() ? 0 : groups.size() - 1;  // one is left for training
  const std::size_t test = std::min(spare, part_of(groups.size(), shares[2]));
  const std::size_t valid = std::min(spare - test, part_of(groups.size(), shares[1]));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    std::vector<std::size_t>& part = i < test ? masks.test : i < test + valid ? masks.valid : masks.train;
    part.insert(part.end(), groups[i].begin(), groups[i].end());
  }
  for (auto* part : {&masks.train, &masks.valid, &masks.test}) std::sort(part->begin(), part->end());
  return masks;
}

}  // namespace slipbench
