// Lists of files that a user names.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "tools/base/files/reject.h"

namespace slipbench {

// Throws InputError where two of `paths` are one file, whose content would count twice. `what`: the word for a file, such as
// "dataset". Files that are not there are left to their readers.
inline void check_given_once(const std::vector<std::string>& paths, std::string_view what) {
  std::set<std::filesystem::path> given;
  for (const std::string& path : paths) {
    std::error_code unreadable;
    if (!given.insert(std::filesystem::weakly_canonical(path, unreadable)).second)
      reject("{}: was given before; allowed: each {} once", path, what);
  }
}

}  // namespace slipbench
