#include "tools/base/project/project_file.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

std::optional<std::string> find_project_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (const fs::path& root : {program.parent_path().parent_path() / "share/slipbench", fs::path(SLIPBENCH_SOURCE_DIR)}) {
    if (fs::exists(root / path, error)) return (root / path).string();
  }
  return std::nullopt;
}

std::string project_file(const std::string& path) {
  if (std::optional<std::string> found = find_project_file(path)) return *found;
  throw InputError(fmt::format("{}: neither installed with the program nor in the source tree {}", path, SLIPBENCH_SOURCE_DIR));
}

}  // namespace slipbench
