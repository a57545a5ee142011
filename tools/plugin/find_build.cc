// libslipbench_mujoco.so, for mj_loadPluginLibrary of any MuJoCo. It links to no MuJoCo: it finds
// the one that is loaded, and loads the build for that release from its own folder. Without such a
// build it lists the supported releases.
#include "tools/plugin/loaded_mujocos.h"
#include "tools/plugin/plugin_builds.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

fs::path own_folder() {
  static const char here = 0;
  Dl_info info{};
  return ::dladdr(&here, &info) != 0 ? fs::path(info.dli_fname).parent_path() : fs::path();
}

void load_build_for(const std::string& file) {
  void* const mujoco = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_NOLOAD);
  const std::string version = version_of(mujoco);
  if (version.empty()) return warn(mujoco, "slipbench.field: " + file + " does not state its version");
  const std::string build = plugin_build(version);
  if (build.empty()) {
    warn(mujoco, "slipbench.field: MuJoCo " + version +
                     " is loaded, but the plugin has no build for it; supported: " + plugin_versions_text);
  } else if (::dlopen((own_folder() / build).c_str(), RTLD_NOW | RTLD_LOCAL) == nullptr) {
    warn(mujoco, std::string("slipbench.field: ") + ::dlerror());
  }
}

[[gnu::constructor]] void load_builds() {
  const std::vector<std::string> files = loaded_mujocos();
  if (files.empty()) warn(nullptr, "slipbench.field: no libmujoco.so is loaded, so the plugin is not registered");
  for (const std::string& file : files) load_build_for(file);
}

}  // namespace
}  // namespace slipbench
