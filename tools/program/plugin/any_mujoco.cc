#include <algorithm>
#include <iterator>
#include <string_view>

#include "sim/mujoco/mujoco_differences.h"
#include "tools/program/plugin/loaded_mujocos.h"

namespace slipbench::any_mujoco {
namespace {

constexpr std::string_view releases[] = {SLIPBENCH_MUJOCO_RELEASES};

constexpr int table[row_count][std::size(releases)] = {
#define SLIPBENCH_ROW(type, name, ...) {__VA_ARGS__},
    SLIPBENCH_COUNT_MEMBERS(SLIPBENCH_ROW) SLIPBENCH_MODEL_MEMBERS(SLIPBENCH_ROW) SLIPBENCH_OPTION_MEMBERS(SLIPBENCH_ROW)
        SLIPBENCH_FORCE_MEMBERS(SLIPBENCH_ROW) SLIPBENCH_DATA_MEMBERS(SLIPBENCH_ROW)
#undef SLIPBENCH_ROW
#define SLIPBENCH_ROW(name, ...) {__VA_ARGS__},
            SLIPBENCH_MUJOCO_NUMBERS(SLIPBENCH_ROW)
#undef SLIPBENCH_ROW
};

}  // namespace

int places[row_count];
Calls calls;

bool choose() {
  std::string others;
  for (const std::string& file : loaded_mujocos()) {
    void* const mujoco = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_NOLOAD);
    const std::string version = version_of(mujoco);
    const auto release = std::ranges::find(releases, version);
    if (release == std::end(releases)) {
      others += " " + version;
      continue;
    }
    std::ranges::transform(table, places, [&](const auto& row) { return row[release - releases]; });
    // What a release lacks stays null, and is called in none that lacks it.
#define SLIPBENCH_FIND(name) calls.name##_ = mujoco_function<decltype(calls.name##_)>(mujoco, #name);
    SLIPBENCH_MUJOCO_CALLS(SLIPBENCH_FIND)
#undef SLIPBENCH_FIND
    return true;
  }
  warn(nullptr, "slipbench.field: this build is for MuJoCo " + std::string(releases[0]) + " to " +
                    std::string(*std::rbegin(releases)) + ", loaded is:" + (others.empty() ? " none" : others));
  return false;
}

}  // namespace slipbench::any_mujoco
