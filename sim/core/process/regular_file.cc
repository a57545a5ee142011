#include "sim/core/process/regular_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "sim/core/counted.h"
#include "sim/core/error.h"

namespace slipbench {

namespace fs = std::filesystem;

void check_regular_file(const std::string& path) {
  std::error_code error;
  switch (fs::status(path, error).type()) {
    case fs::file_type::fifo: throw InputError(path + ": is a pipe, not a file");
    case fs::file_type::socket: throw InputError(path + ": is a socket, not a file");
    case fs::file_type::block:
    case fs::file_type::character: throw InputError(path + ": is a device, not a file");
    case fs::file_type::directory: throw InputError(path + ": is a folder, not a file");
    default: return;
  }
}

void check_regular_file(const std::string& path, std::uintmax_t most) {
  check_regular_file(path);
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error && size > most) {
    throw InputError(path + ": has " + counted(size, "byte") + "; allowed: at most " + std::to_string(most));
  }
}

bool write_whole(int descriptor, std::string_view bytes, std::uint64_t at) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
    at += static_cast<std::uint64_t>(count);
  }
  return true;
}

bool sync_file(int descriptor, bool notes) {
  int status = -1;
  do status = notes ? ::fsync(descriptor) : ::fdatasync(descriptor);
  while (status != 0 && errno == EINTR);
  return status == 0;
}

bool write_synced_file(const char* path, int flags, std::string_view bytes) {
  const int descriptor = ::open(path, O_WRONLY | O_CREAT | O_CLOEXEC | flags, 0666);
  if (descriptor < 0) return false;
  const bool written = write_whole(descriptor, bytes, 0) && sync_file(descriptor);
  const int reason = errno;
  const bool closed = ::close(descriptor) == 0;
  if (!written) errno = reason;
  if (written && closed) return true;
  const int why = errno;
  ::unlink(path);
  errno = why;
  return false;
}

}  // namespace slipbench
