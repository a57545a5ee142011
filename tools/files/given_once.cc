#include "tools/files/given_once.h"

#include <filesystem>
#include <set>
#include <system_error>

#include "tools/files/reject.h"

namespace slipbench {

void check_given_once(const std::vector<std::string>& paths, std::string_view what) {
  std::set<std::filesystem::path> given;
  for (const std::string& path : paths) {
    std::error_code unreadable;
    if (!given.insert(std::filesystem::weakly_canonical(path, unreadable)).second)
      reject("{}: was given twice; give each {} once", path, what);
  }
}

}  // namespace slipbench
