#include "tools/program/export/output_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

OutputFolder::~OutputFolder() {
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) ::rmdir(folder->c_str());  // which only an empty one is
}

std::string OutputFolder::write(const std::string& name, const TextKind& kind, const std::string& bytes) {
  const std::string path = prepare(name);
  check_text_target(path, inputs_, kind);
  write_text_file(path, bytes);
  return path;
}

std::string OutputFolder::prepare(const std::string& name) {
  // Sensors, materials and channels give files their names, and a dataset's texts may be anybody's.
  const std::filesystem::path parts(name);
  if (printable(name) != name || parts.is_absolute() || std::ranges::find(parts, std::filesystem::path("..")) != parts.end()) {
    throw InputError(
        fmt::format("cannot write a file called {}; allowed: names of the dataset without control characters, that stay in {}",
                    quote(name), path_));
  }
  make(path_);
  const std::filesystem::path path = std::filesystem::path(path_) / name;
  if (const std::string folder = path.parent_path().string(); name.find('/') != std::string::npos) make(folder);
  return path.string();
}

void OutputFolder::make(const std::string& folder) {
  if (::mkdir(folder.c_str(), 0777) == 0) {
    made_.push_back(folder);
    return;
  }
  const int reason = errno;
  if (reason == EEXIST && std::filesystem::is_directory(folder)) return;
  throw InputError(fmt::format("cannot make folder {}: {}", folder, std::strerror(reason)));
}

}  // namespace slipbench
