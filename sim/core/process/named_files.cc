#include "sim/core/process/named_files.h"

#include <algorithm>
#include <array>
#include <system_error>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

// Absolute, without links and "..", as far as the path exists.
fs::path resolved(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? fs::path() : found;
}

bool is_inside(const fs::path& path, const fs::path& folder) {
  if (folder.empty()) return false;
  const fs::path whole = folder.has_filename() ? folder : folder.parent_path();
  const auto [end, rest] = std::mismatch(whole.begin(), whole.end(), path.begin(), path.end());
  return end == whole.end();
}

}  // namespace

bool may_be_named(const fs::path& path, const fs::path& folder) {
  const fs::path file = resolved(path), data(own_path(SLIPBENCH_DATA));
  // A build links its source tree.
  const std::array folders{resolved(folder.empty() ? "." : folder), resolved("."), resolved(data), resolved(data / "source")};
  return std::ranges::any_of(folders, [&](const fs::path& one) { return is_inside(file, one); });
}

void refuse_named_file(const fs::path& path, const std::string& place, const std::string& remedy) {
  throw InputError(place + ": " + quote(path.string()) +
                   " is outside of the folder of this file and of the current folder; to read it, " +
                   (remedy.empty() ? "" : "name it on the command line, " + remedy + ", or ") +
                   "start the command in a folder that contains it");
}

void check_named_file(const fs::path& path, const fs::path& folder, const std::string& place, const std::string& remedy) {
  std::error_code error;
  if (fs::exists(path, error) && !may_be_named(path, folder)) refuse_named_file(path, place, remedy);
}

}  // namespace slipbench
