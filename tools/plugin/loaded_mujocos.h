// MuJoCo libraries loaded in this process.
#pragma once

#include <dlfcn.h>
#include <link.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace slipbench {

// Their files. Both Python's own MuJoCo and that of slipbench's simulations may be loaded.
inline std::vector<std::string> loaded_mujocos() {
  std::vector<std::string> files;
  ::dl_iterate_phdr(
      [](dl_phdr_info* info, std::size_t, void* found) {
        if (std::filesystem::path(info->dlpi_name).filename().string().starts_with("libmujoco.so")) {
          static_cast<std::vector<std::string>*>(found)->push_back(info->dlpi_name);
        }
        return 0;
      },
      &files);
  return files;
}

// A function of one of them, or null.
template <class Function>
Function mujoco_function(void* mujoco, const char* name) {
  return reinterpret_cast<Function>(mujoco == nullptr ? nullptr : ::dlsym(mujoco, name));
}

// Its version; empty if the library does not report one.
inline std::string version_of(void* mujoco) {
  const auto version = mujoco_function<const char* (*)()>(mujoco, "mj_versionString");
  return version == nullptr ? "" : version();
}

// Not mju_error(): it may jump out of the loader while it runs a library's constructors, and leave
// the loader locked.
inline void warn(void* mujoco, const std::string& text) {
  if (const auto warning = mujoco_function<void (*)(const char*, ...)>(mujoco, "mju_warning")) {
    warning("%s", text.c_str());
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
}

}  // namespace slipbench
