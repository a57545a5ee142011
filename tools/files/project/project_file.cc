#include "tools/files/project/project_file.h"

#include <filesystem>
#include <system_error>

#include "sim/core/process/own_library.h"
#include "tools/files/reject.h"

namespace slipbench {

namespace {

namespace fs = std::filesystem;

// Path of a project file; empty if it does not exist.
std::string found_file(const fs::path& path) {
  std::error_code error;
  const fs::path data(own_path(SLIPBENCH_DATA));
  if (fs::exists(data / path, error)) return (data / path).string();
  const fs::path source = fs::canonical(data / "source", error);
  return !error && fs::exists(source / path, error) ? (source / path).string() : "";
}

}  // namespace

std::string project_file(const std::string& path) {
  std::string found = found_file(path);
  if (found.empty()) {
    reject("{}: not found in {}, where the program is installed, and not in the source tree of a build folder", path,
           own_path(SLIPBENCH_DATA));
  }
  return found;
}

std::string scene_path(const std::string& name) {
  std::error_code error;
  const fs::path path(name);
  if (path.extension() != ".yaml" || path.is_absolute() || fs::exists(path, error)) return name;
  for (const fs::path& shipped : {fs::path("scenes") / path, path}) {
    if (std::string found = found_file(shipped); !found.empty()) return found;
  }
  return name;
}

}  // namespace slipbench
