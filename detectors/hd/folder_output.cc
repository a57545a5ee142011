#include "detectors/hd/folder_output.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include "sim/core/error.h"
#include "sim/core/process/whole_write.h"

namespace slipbench::hd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& folder, const std::error_code& reason) {
  throw InputError(folder + ": cannot write: " + reason.message());
}

std::error_code last_error() { return {errno, std::generic_category()}; }

// Without the slash of "folder/".
fs::path whole_name(const std::string& folder) {
  const fs::path name = fs::absolute(folder).lexically_normal();
  return name.has_filename() ? name : name.parent_path();
}

}  // namespace

void check_folder_target(const std::string& folder, const std::vector<std::string>& own_names) {
  const fs::path target = whole_name(folder);
  try {
    if (fs::exists(fs::symlink_status(target))) {
      if (!fs::is_directory(fs::symlink_status(target)))
        throw InputError(target.string() + ": is no folder; allowed: a new name, or a folder of a model");
      for (const fs::directory_entry& entry : fs::directory_iterator(target)) {
        const std::string name = entry.path().filename().string();
        if (std::ranges::find(own_names, name) == own_names.end()) {
          throw InputError(target.string() + ": holds " + quote(name) + ", which is no part of a model; give another name");
        }
      }
    }
    fs::path above = target.parent_path();
    while (!fs::exists(above)) above = above.parent_path();
    if (!fs::is_directory(above)) refuse(target, std::make_error_code(std::errc::not_a_directory));
    if (::access(above.c_str(), W_OK | X_OK) != 0) refuse(target, last_error());
  } catch (const std::system_error& error) {
    refuse(target, error.code());
  }
}

void replace_folder(const std::string& fresh, const std::string& target, const std::string& stale) {
  const bool stands = fs::exists(target);
  if (stands) fs::rename(target, stale);
  try {
    fs::rename(fresh, target);
  } catch (const fs::filesystem_error&) {
    if (stands) fs::rename(stale, target);
    throw;
  }
}

void write_folder(const std::string& folder, const std::vector<TextFile>& files) {
  const fs::path target = whole_name(folder);
  const std::string fresh = target.string() + ".partial." + std::to_string(::getpid());
  const std::string stale = target.string() + ".old." + std::to_string(::getpid());
  try {
    fs::create_directories(fresh);
    for (const TextFile& file : files) {
      // A link that stands there is not followed.
      if (!write_synced_file((fs::path(fresh) / file.name).c_str(), O_EXCL, file.text)) throw std::system_error(last_error());
    }
    replace_folder(fresh, target, stale);
  } catch (const std::system_error& error) {
    std::error_code ignored;
    fs::remove_all(fresh, ignored);
    refuse(target, error.code());
  }
  std::error_code error;
  fs::remove_all(stale, error);
  if (error) throw InputError(target.string() + ": written, but what stood there is still at " + stale + ": " + error.message());
}

}  // namespace slipbench::hd
