#include "tools/base/files/scratch_folder.h"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  path_ = ((error ? fs::path("/tmp") : parent) / "slipbench-XXXXXX").string();
  if (::mkdtemp(path_.data()) == nullptr)
    throw InputError(fmt::format("cannot make a folder {}: {}", path_, std::generic_category().message(errno)));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace slipbench
