#include "tools/studies/counts/compare.h"

#include <algorithm>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/studies/counts/count.h"

namespace slipbench::counts {
namespace {

std::vector<FunctionChange> changed_functions(const SceneCount& before, const SceneCount& now) {
  std::map<std::string, std::uint64_t> current;
  for (const FunctionCount& function : now.functions) current[function.name] = function.instructions;
  std::vector<FunctionChange> changes;
  for (const FunctionCount& function : before.functions) {
    const auto found = current.find(function.name);
    changes.push_back({function.name, function.instructions, found == current.end() ? 0 : found->second});
    if (found != current.end()) current.erase(found);
  }
  // Of a function that the file does not list it is known only that it was no dearer than the cheapest that it lists.
  const std::uint64_t cheapest = before.functions.back().instructions;
  for (const auto& [name, instructions] : current) {
    if (instructions > cheapest) changes.push_back({name, cheapest, instructions, false});
  }
  std::erase_if(changes, [](const FunctionChange& change) { return change.difference() == 0; });
  std::ranges::stable_sort(changes, std::ranges::greater{},
                           [](const FunctionChange& change) { return std::abs(change.difference()); });
  return changes;
}

}  // namespace

void check_comparable(const Results& before, const Facts& build, const std::string& path) {
  if (const std::string difference = differences(before.build, build); !difference.empty()) {
    throw InputError(fmt::format("{}: counts of another build cannot be compared: it is of another {}", path, difference));
  }
  if (!std::ranges::equal(before.scenes, reference_scenes(), {}, &SceneCount::scene)) {
    std::string found;
    for (const SceneCount& scene : before.scenes) found += (found.empty() ? "" : ", ") + scene.scene;
    throw InputError(fmt::format("{}: its scenes are {}; allowed: {}; to count again: slipbench bench -o {}", path, found,
                                 fmt::join(reference_scenes(), ", "), path));
  }
}

std::vector<SceneChange> compare(const Results& before, const Results& now) {
  std::vector<SceneChange> changes;
  for (std::size_t i = 0; i < now.scenes.size(); ++i) {
    const SceneCount& old = before.scenes.at(i);
    const SceneCount& fresh = now.scenes[i];
    changes.push_back({fresh.scene, old.instructions, fresh.instructions, old.steps, fresh.steps, changed_functions(old, fresh)});
  }
  return changes;
}

}  // namespace slipbench::counts
