// In which releases of MuJoCo the plugin works, and which of its builds does.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace slipbench {

// "3.3.7, 4.0.1": oldest first, the bench's own last. tools/program/plugin/CMakeLists.txt makes a build for each.
inline constexpr const char* plugin_versions_text = SLIPBENCH_PLUGIN_VERSIONS;

inline std::vector<std::string> plugin_versions() {
  std::vector<std::string> versions;
  const std::string text = plugin_versions_text;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(", ", begin), text.size());
    versions.push_back(text.substr(begin, end - begin));
    begin = end + 2;
  }
  return versions;
}

// The name of its build's file, or nothing where there is none.
inline std::string plugin_build(const std::string& version) {
  const std::vector<std::string> versions = plugin_versions();
  return std::ranges::find(versions, version) == versions.end() ? "" : "libslipbench_mujoco-" + version + ".so";
}

}  // namespace slipbench
