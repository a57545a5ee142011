// In which versions of MuJoCo the plugin works, and which of its builds does.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "tools/program/plugin/mujoco_layouts.h"

namespace slipbench {

// Oldest first, the bench's own last.
inline const std::vector<std::string>& plugin_versions() {
  static const std::vector<std::string> versions{SLIPBENCH_MUJOCO_RELEASES, SLIPBENCH_MUJOCO_VERSION};
  return versions;
}

// The name of its build's file, or nothing where there is none.
inline std::string plugin_build(const std::string& version) {
  const std::vector<std::string>& versions = plugin_versions();
  if (std::ranges::find(versions, version) == versions.end()) return "";
  return "libslipbench_mujoco-" + (version == versions.back() ? version : "others") + ".so";
}

// "3.3.0, ..., 4.0.1; the nearest is 3.17.0": the newest that is not newer than what is wanted, else the oldest.
inline std::string plugin_versions_text(const std::string& wanted) {
  const auto numbers = [](const std::string& version) {
    std::array<int, 3> parts{};
    std::sscanf(version.c_str(), "%d.%d.%d", &parts[0], &parts[1], &parts[2]);
    return parts;
  };
  std::string list, nearest = plugin_versions().front();
  for (const std::string& version : plugin_versions()) {
    list += (list.empty() ? "" : ", ") + version;
    if (numbers(version) <= numbers(wanted)) nearest = version;
  }
  return list + "; the nearest is " + nearest;
}

}  // namespace slipbench
