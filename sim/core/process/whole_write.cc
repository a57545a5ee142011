#include "sim/core/process/whole_write.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace slipbench {

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
