#include "tools/base/dataset/mask.h"

#include <algorithm>
#include <map>

#include "sim/core/random.h"

namespace slipbench {
namespace {

// 15 % of `count`, rounded to the nearest, at least one.
std::size_t share(std::size_t count) { return std::max<std::size_t>(1, (15 * count + 50) / 100); }

}  // namespace

Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed) {
  std::map<std::string, std::vector<std::size_t>> by_material;
  for (const auto& [trial, material] : trials) by_material[material].push_back(trial);

  Masks masks;
  masks.split_by = by_material.size() > 1 ? "material" : "trial";
  std::vector<std::vector<std::size_t>> groups;
  if (by_material.size() > 1) {
    for (auto& [material, members] : by_material) groups.push_back(std::move(members));
  } else {
    for (const auto& [trial, material] : trials) groups.push_back({trial});
  }

  RandomStream random(seed, 0, "mask");
  for (std::size_t left = groups.size(); left > 1; --left) {  // Fisher-Yates
    std::swap(groups[left - 1], groups[static_cast<std::size_t>(random.integer(left))]);
  }
  const std::size_t test = groups.size() >= 2 ? share(groups.size()) : 0;
  const std::size_t valid = groups.size() >= 3 ? share(groups.size()) : 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    std::vector<std::size_t>& part = i < test ? masks.test : i < test + valid ? masks.valid : masks.train;
    part.insert(part.end(), groups[i].begin(), groups[i].end());
  }
  for (auto* part : {&masks.train, &masks.valid, &masks.test}) std::sort(part->begin(), part->end());
  return masks;
}

}  // namespace slipbench
