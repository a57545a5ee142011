#include "tools/base/files/file_lock.h"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "sim/core/error.h"

namespace slipbench {

Descriptor::~Descriptor() {
  if (value_ >= 0) ::close(value_);
}

Descriptor lock_file(const std::string& path) {
  const auto refuse = [&](const char* reason) { throw InputError("cannot write " + path + ": " + reason); };
  // A link that has come since the name was checked is not followed.
  Descriptor descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) refuse(std::strerror(errno));
  if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
    refuse(errno == EWOULDBLOCK ? "another run is writing it" : std::strerror(errno));
  }
  // Between the two calls the run that had the lock may have given the file its final name, under which it is not this run's.
  struct stat locked {
  }, named{};
  if (::fstat(descriptor.get(), &locked) != 0) refuse(std::strerror(errno));
  if (::stat(path.c_str(), &named) != 0 || locked.st_ino != named.st_ino || locked.st_dev != named.st_dev) {
    refuse("another run is writing it");
  }
  return descriptor;
}

}  // namespace slipbench
