// Releases of MuJoCo that the plugin supports, and the build for each.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace slipbench {

// "3.3.7, 4.0.1": oldest first, slipbench's own last. tools/plugin/CMakeLists.txt creates a
// build for each.
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

// File name of the release's build, or "" if there is none.
inline std::string plugin_build(const std::string& version) {
  const std::vector<std::string> versions = plugin_versions();
  return std::ranges::find(versions, version) == versions.end() ? "" : "libslipbench_mujoco-" + version + ".so";
}

}  // namespace slipbench
