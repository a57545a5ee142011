#include "detectors/hd/shipped_memories.h"

#include <filesystem>
#include <system_error>

#include "sim/core/error.h"
#include "sim/core/process/own_library.h"

namespace slipbench::hd {

std::string shipped_memories(const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::path(own_path(SLIPBENCH_HD_MEMORIES)) / name;
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError("the program's own memories " + quote(name) + " are not at " + folder.string() +
                     "; allowed: a folder with AM.hex, CIM.hex, CM.hex and IM.hex");
  }
  return folder.string();
}

std::string memories_folder(const std::string& name) {
  std::error_code error;
  return name == default_memories && !std::filesystem::exists(name, error) ? shipped_memories(name) : name;
}

}  // namespace slipbench::hd
