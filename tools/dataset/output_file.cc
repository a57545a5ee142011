#include "tools/dataset/output_file.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/dataset/header.h"

namespace slipbench {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw InputError(fmt::format("cannot write {}: {}", path, reason));
}

}  // namespace

bool begins_as_hdf5(const std::string& path) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::array<char, 8> found{};
  std::ifstream file(path, std::ios::binary);
  return file.read(found.data(), found.size()) && found == signature;
}

void check_target(const std::string& path) {
  if (path.empty() || path.back() == '/') {
    throw InputError(fmt::format("cannot write '{}': no file name; allowed: a path such as out.h5", path));
  }
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (S_ISLNK(status.st_mode)) {
      std::error_code error;
      refuse(path,
             fmt::format("it is a symbolic link; give the file itself, {}", std::filesystem::read_symlink(path, error).string()));
    }
    if (S_ISDIR(status.st_mode)) refuse(path, fmt::format("it is a folder; allowed: a file in it, such as {}/out", path));
    if (!S_ISREG(status.st_mode)) refuse(path, "it is no regular file");
    // The file would be replaced, not written to, so that the system would not object; its owner meant it to stay.
    if (::access(path.c_str(), W_OK) != 0 || (status.st_mode & 0222U) == 0) refuse(path, "it is read-only");
    return;
  }
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder)) {
    refuse(path, fmt::format("there is no folder {}", folder.string()));
  }
}

void check_text_target(const std::string& path, const std::string& input) {
  check_target(path);
  // The temporary name is written to as well, and could be that of a killed run's dataset.
  for (const std::string& name : {path, temporary_path(path)}) {
    std::error_code error;
    if (std::filesystem::equivalent(name, input, error)) refuse(path, fmt::format("{} is the input", name));
    if (begins_as_hdf5(name)) refuse(path, fmt::format("{} is an HDF5 file, perhaps a dataset", name));
  }
}

void write_text_file(const std::string& path, const std::string& text) {
  const std::string temporary = temporary_path(path);
  const auto fail = [&](int reason) {
    std::remove(temporary.c_str());
    refuse(path, std::strerror(reason));
  };
  std::FILE* const file = std::fopen(temporary.c_str(), "wb");
  if (file == nullptr) refuse(path, std::strerror(errno));
  const bool written =
      std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0 && ::fsync(::fileno(file)) == 0;
  const int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written) fail(reason);
  if (!closed || std::rename(temporary.c_str(), path.c_str()) != 0) fail(errno);
}

}  // namespace slipbench
