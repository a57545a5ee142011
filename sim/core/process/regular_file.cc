#include "sim/core/process/regular_file.h"

#include <filesystem>
#include <system_error>

#include "sim/core/error.h"

namespace slipbench {

namespace fs = std::filesystem;

void check_regular_file(const std::string& path) {
  std::error_code error;
  switch (fs::status(path, error).type()) {
    case fs::file_type::fifo: throw InputError(path + ": is a pipe, no file");
    case fs::file_type::socket: throw InputError(path + ": is a socket, no file");
    case fs::file_type::block:
    case fs::file_type::character: throw InputError(path + ": is a device, no file");
    case fs::file_type::directory: throw InputError(path + ": is a folder, no file");
    default: return;
  }
}

void check_regular_file(const std::string& path, std::uintmax_t most) {
  check_regular_file(path);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error && size > most) {
    throw InputError(path + ": has " + std::to_string(size) + " bytes; allowed: at most " + std::to_string(most));
  }
}

}  // namespace slipbench
