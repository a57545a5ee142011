#include "tools/files/output_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>

#include <fmt/ranges.h>
#include <openssl/evp.h>

#include "sim/core/process/regular_file.h"
#include "tools/files/delayed_end.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& reason) { reject("cannot write {}: {}", path, reason); }

// The first 4 kB of a file; empty if it cannot be read.
std::string first_bytes(const std::string& path) {
  std::string bytes(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

}  // namespace

std::string temporary_path(const std::string& path) { return path + ".partial"; }

void rename_file(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) reject("cannot rename {} to {}: {}", from, to, std::strerror(errno));
}

void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Descriptor descriptor(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() < 0 || !sync_file(descriptor.get(), true)) {
    reject("cannot sync the folder of {}, so a power failure may lose its name: {}", path, std::strerror(errno));
  }
}

void check_target(const std::string& path) {
  if (path.empty() || path.back() == '/') reject("cannot write '{}': not a file name; expected a path such as out.h5", path);
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (S_ISLNK(status.st_mode)) {
      std::error_code error;
      refuse(path, fmt::format("it is a symbolic link to {}, which would be replaced, not followed; give a file or a new name",
                               std::filesystem::read_symlink(path, error).string()));
    }
    if (S_ISDIR(status.st_mode)) refuse(path, fmt::format("it is a folder; give a file in it, such as {}/out", path));
    if (!S_ISREG(status.st_mode)) refuse(path, "it is not a regular file");
    // The system would allow replacing a read-only file, but its owner wants to keep it.
    if (::access(path.c_str(), W_OK) != 0 || (status.st_mode & 0222U) == 0) refuse(path, "it is read-only");
    return;
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!folder.empty() && !std::filesystem::is_directory(folder, error)) {
    const bool missing = !error || error == std::errc::no_such_file_or_directory;
    refuse(path, missing ? fmt::format("the folder {} does not exist", folder.string())
                         : fmt::format("the folder {}: {}", folder.string(), error.message()));
  }
}

void check_text_target(const std::string& path, const std::vector<std::string>& inputs, const TextKind& kind) {
  for (const std::string& name : {path, temporary_path(path)}) {
    check_target(name);
    for (const std::string& input : inputs) {
      std::error_code error;
      if (std::filesystem::equivalent(name, input, error)) refuse(path, fmt::format("{} is an input", name));
    }
    const std::string found = first_bytes(name);
    if (!found.empty() && !kind.begins(found)) {
      refuse(path, fmt::format("{} exists and is not a {}; choose a new name, or a {} to replace", name, kind.name, kind.name));
    }
  }
}

void write_text_file(const std::string& path, const std::string& text) { write_text_files({{path, text}}); }

void write_text_files(const std::vector<std::pair<std::string, std::string>>& files) {
  const DelayedEnd until_renamed;
  std::vector<std::string> written;  // temporary files without their final name
  const auto give_up = [&written](const std::string& path) {
    const int reason = errno;
    for (const std::string& temporary : written) std::remove(temporary.c_str());
    refuse(path, std::strerror(reason));
  };
  for (const auto& [path, text] : files) {
    const std::string temporary = temporary_path(path);
    // Always a new file: one that a killed run left may be a hard link to a file that must not change.
    struct stat left {};
    if (::lstat(temporary.c_str(), &left) == 0 && S_ISREG(left.st_mode) && ::unlink(temporary.c_str()) != 0) give_up(path);
    if (!write_synced_file(temporary.c_str(), O_EXCL, text)) give_up(path);
    written.push_back(temporary);
  }
  for (const auto& [path, text] : files) {
    if (std::rename(written.front().c_str(), path.c_str()) != 0) give_up(path);
    written.erase(written.begin());
  }
}

namespace fs = std::filesystem;

ScratchFolder::ScratchFolder() {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  path_ = ((error ? fs::path("/tmp") : parent) / "slipbench-XXXXXX").string();
  if (::mkdtemp(path_.data()) == nullptr) reject("cannot make a folder {}: {}", path_, std::generic_category().message(errno));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

Descriptor::~Descriptor() {
  if (value_ >= 0) ::close(value_);
}

Descriptor lock_file(const std::string& path) {
  const auto refuse = [&](const char* reason) { throw InputError("cannot write " + path + ": " + reason); };
  // O_NOFOLLOW: a link may have appeared since the name was checked.
  Descriptor descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (descriptor.get() < 0) refuse(std::strerror(errno));
  if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0) {
    refuse(errno == EWOULDBLOCK ? "another run is writing it" : std::strerror(errno));
  }
  // Between open() and flock() the run that held the lock may have renamed the file to its final
  // name.
  struct stat locked {
  }, named{};
  if (::fstat(descriptor.get(), &locked) != 0) refuse(std::strerror(errno));
  if (::stat(path.c_str(), &named) != 0 || locked.st_ino != named.st_ino || locked.st_dev != named.st_dev) {
    refuse("another run is writing it");
  }
  return descriptor;
}

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (context_ == nullptr || EVP_DigestInit_ex(context_, EVP_sha256(), nullptr) != 1) {
    EVP_MD_CTX_free(context_);
    throw std::bad_alloc();
  }
}

Sha256::~Sha256() { EVP_MD_CTX_free(context_); }

void Sha256::update(const void* bytes, std::size_t size) { EVP_DigestUpdate(context_, bytes, size); }

Digest Sha256::finish() {
  Digest digest{};
  EVP_DigestFinal_ex(context_, digest.data(), nullptr);
  EVP_DigestInit_ex(context_, nullptr, nullptr);  // reset with the same algorithm
  return digest;
}

std::string hexadecimal(const Digest& digest) { return fmt::format("{:02x}", fmt::join(digest, "")); }

}  // namespace slipbench
