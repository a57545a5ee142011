#include "tools/files/project/project_file.h"

#include <filesystem>
#include <system_error>

#include "sim/core/process/own_library.h"
#include "tools/files/reject.h"

namespace slipbench {

std::string project_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path data(own_path(SLIPBENCH_DATA));
  if (fs::exists(data / path, error)) return (data / path).string();
  const fs::path source = fs::canonical(data / "source", error);
  if (!error && fs::exists(source / path, error)) return (source / path).string();
  reject("{}: neither installed with the program, in {}, nor in the source tree of a build folder", path, data.string());
}

}  // namespace slipbench
