#include "sim/mujoco/releases/release_table.h"

#include <dlfcn.h>

#include <cstring>
#include <filesystem>
#include <system_error>

#include "sim/mujoco/releases/layouts.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

#define SLIPBENCH_COUNT(name) #name " "
#define SLIPBENCH_VALUE(type, name, member) #name " "
#define SLIPBENCH_ARRAY(type, name) #name " "
constexpr const char* members = SLIPBENCH_MODEL_MEMBERS(SLIPBENCH_COUNT, SLIPBENCH_VALUE, SLIPBENCH_ARRAY)
    SLIPBENCH_DATA_MEMBERS(SLIPBENCH_VALUE, SLIPBENCH_ARRAY) SLIPBENCH_METRIC_MODEL_MEMBERS(SLIPBENCH_COUNT)
        SLIPBENCH_METRIC_DATA_MEMBERS(SLIPBENCH_VALUE, SLIPBENCH_ARRAY);
#undef SLIPBENCH_COUNT
#undef SLIPBENCH_VALUE
#undef SLIPBENCH_ARRAY

fs::path layout_library(const std::string& version, const std::string& folder) {
  return fs::path(folder) / ("libslipbench_layout-" + version + ".so");
}

std::string in_quotes(const fs::path& path) { return "'" + path.string() + "'"; }

// Returns the folder that contains mujoco/mujoco.h of a MuJoCo: that of a wheel, of an archive or of
// a package of the system.
std::string headers_of(const std::string& mujoco_file) {
  const fs::path folder = fs::path(mujoco_file).parent_path();
  for (const fs::path& headers : {folder / "include", folder.parent_path() / "include"}) {
    std::error_code error;
    if (!mujoco_file.empty() && fs::exists(headers / "mujoco/mujoco.h", error)) return in_quotes(headers);
  }
  return "FOLDER_OF_ITS_HEADERS";
}

}  // namespace

std::vector<std::string> known_releases() {
  std::vector<std::string> versions;
  for (const Release& release : releases) versions.emplace_back(release.version);
  return versions;
}

std::optional<SlipbenchLayout> find_layout(const std::string& version, const std::string& folder) {
  for (const Release& release : releases) {
    if (version == release.version) return release.layout;
  }
  void* const library = ::dlopen(layout_library(version, folder).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return std::nullopt;
  const auto* names = static_cast<const char*>(::dlsym(library, "slipbench_mujoco_members"));
  const auto* layout = static_cast<const SlipbenchLayout*>(::dlsym(library, "slipbench_mujoco_layout"));
  if (names == nullptr || layout == nullptr || std::strcmp(names, members) != 0) return std::nullopt;
  return *layout;
}

std::string how_to_add(const std::string& version, const std::string& folder, const std::string& mujoco_file) {
  std::string known;
  for (const Release& release : releases) known += (known.empty() ? "" : ", ") + std::string(release.version);
  return "the plugin does not know MuJoCo " + version + " (known: " + known +
         "). To add it, run this command, and start again:\n  cc -shared -fPIC -I" + headers_of(mujoco_file) + " -o " +
         in_quotes(layout_library(version, folder)) + " " + in_quotes(fs::path(folder) / "mujoco_layout/layout.c");
}

}  // namespace slipbench
