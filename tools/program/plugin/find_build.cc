// libslipbench_mujoco.so: what mj_loadPluginLibrary loads, in whatever MuJoCo. It needs none itself: it looks which one is loaded, and loads the
// build for that version, libslipbench_mujoco-VERSION.so beside it. Where there is none it says so, with both versions.
#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace {

namespace fs = std::filesystem;

// Known before any constructor runs.
constexpr std::string_view prefix = "libslipbench_mujoco-", suffix = ".so";

fs::path own_folder() {
  static const char here = 0;
  Dl_info info{};
  return ::dladdr(&here, &info) != 0 ? fs::path(info.dli_fname).parent_path() : fs::path();
}

// The files of all MuJoCo libraries in the process. Python's own and that of slipbench's simulations may both be.
std::vector<std::string> loaded_mujocos() {
  std::vector<std::string> files;
  ::dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* found) {
        if (fs::path(info->dlpi_name).filename().string().starts_with("libmujoco.so")) {
          static_cast<std::vector<std::string>*>(found)->push_back(info->dlpi_name);
        }
        return 0;
      },
      &files);
  return files;
}

std::string builds_in(const fs::path& folder) {
  std::vector<std::string> versions;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(suffix)) {
      versions.push_back(name.substr(prefix.size(), name.size() - prefix.size() - suffix.size()));
    }
  }
  std::ranges::sort(versions);
  std::string list;
  for (const std::string& version : versions) list += (list.empty() ? "" : ", ") + version;
  return list.empty() ? "none" : list;
}

std::string build_for(const std::string& version) { return std::string(prefix).append(version).append(suffix); }

// No mju_error: it may jump over the loader that is running a library's constructors, which would then stay locked.
void warn(void* mujoco, const std::string& text) {
  using Warning = void (*)(const char*, ...);
  if (const auto mju_warning = reinterpret_cast<Warning>(mujoco == nullptr ? nullptr : ::dlsym(mujoco, "mju_warning"))) {
    mju_warning("%s", text.c_str());
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
}

void load_build_for(const std::string& file) {
  void* const mujoco = ::dlopen(file.c_str(), RTLD_LAZY | RTLD_NOLOAD);
  using Version = const char* (*)();
  const auto mj_version_string = reinterpret_cast<Version>(mujoco == nullptr ? nullptr : ::dlsym(mujoco, "mj_versionString"));
  if (mj_version_string == nullptr) return warn(mujoco, "slipbench.field: " + file + " does not say which MuJoCo it is");
  const std::string version = mj_version_string();
  const fs::path folder = own_folder(), build = folder / build_for(version);
  std::error_code error;
  if (!fs::exists(build, error)) {
    warn(mujoco, "slipbench.field: MuJoCo " + version + " is loaded, and the plugin is built for " + builds_in(folder) +
                     ": it stays unknown. Allowed: one of these, or a build that `./slipbench plugin-path --mujoco " + version +
                     "` makes");
  } else if (::dlopen(build.c_str(), RTLD_NOW | RTLD_LOCAL) == nullptr) {
    warn(mujoco, std::string("slipbench.field: ") + ::dlerror());
  }
}

[[gnu::constructor]] void load_builds() {
  const std::vector<std::string> files = loaded_mujocos();
  if (files.empty()) warn(nullptr, "slipbench.field: no libmujoco.so is loaded: the plugin stays unknown");
  for (const std::string& file : files) load_build_for(file);
}

}  // namespace
