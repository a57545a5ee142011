#include "tools/program/export/output_folder.h"

#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

bool is_gzip(std::string_view beginning) { return beginning.starts_with("\x1f\x8b"); }

// What gzip holds is no other kind of file.
void check_packed(const std::string& path, const TextKind& kind) {
  std::ifstream file(path, std::ios::binary);
  std::string beginning(1 << 12, '\0');
  file.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  beginning.resize(static_cast<std::size_t>(file.gcount()));
  if (beginning.empty() || kind.begins(beginning_of_gzip(beginning))) return;
  throw InputError(
      fmt::format("cannot write {0}: {0} exists and is no {1}; allowed: a new name, or a {1} to replace", path, kind.name));
}

constexpr int level = 4;               // as datasets have it
constexpr int container = 16;          // of gzip, to be added to the window's bits
constexpr int memory = 8;              // zlib's default
constexpr std::size_t most = 1 << 30;  // bytes that zlib is handed at once: its counters have 32 bits
constexpr std::size_t beginning = 1 << 16;

// zlib takes its input as a pointer to what is not const, and does not change it.
Bytef* input_of(std::string_view bytes) { return reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data())); }

}  // namespace

OutputFolder::~OutputFolder() {
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) ::rmdir(folder->c_str());  // which only an empty one is
}

std::string OutputFolder::write(const std::string& name, const TextKind& kind, const std::string& bytes) {
  const std::string path = prepare(compress_ ? name + ".gz" : name);
  check_text_target(path, inputs_, compress_ ? TextKind{kind.name, &is_gzip} : kind);
  if (compress_) check_packed(path, kind);
  write_text_file(path, compress_ ? gzip(bytes) : bytes);
  return path;
}

std::string OutputFolder::prepare(const std::string& name) {
  // Sensors, materials and channels give files their names, and a dataset's texts may be anybody's.
  const std::filesystem::path parts(name);
  if (printable(name) != name || parts.is_absolute() || std::ranges::find(parts, std::filesystem::path("..")) != parts.end()) {
    throw InputError(
        fmt::format("cannot write a file called {}; allowed: names of the dataset without control characters, that stay in {}",
                    quote(name), path_));
  }
  make(path_);
  const std::filesystem::path path = std::filesystem::path(path_) / name;
  if (const std::string folder = path.parent_path().string(); name.find('/') != std::string::npos) make(folder);
  return path.string();
}

void OutputFolder::make(const std::string& folder) {
  if (::mkdir(folder.c_str(), 0777) == 0) {
    made_.push_back(folder);
    return;
  }
  const int reason = errno;
  if (reason == EEXIST && std::filesystem::is_directory(folder)) return;
  throw InputError(fmt::format("cannot make folder {}: {}; allowed: a folder, or a new name in one that is there", folder,
                               std::strerror(reason)));
}

std::string gzip(std::string_view text) {
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS + container, memory, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::runtime_error("zlib: cannot begin a stream");
  }
  std::string bytes;
  std::string part(beginning, '\0');
  for (int status = Z_OK; status != Z_STREAM_END;) {
    if (stream.avail_in == 0 && !text.empty()) {
      stream.next_in = input_of(text);
      stream.avail_in = static_cast<uInt>(std::min(text.size(), most));
      text.remove_prefix(stream.avail_in);
    }
    stream.next_out = reinterpret_cast<Bytef*>(part.data());
    stream.avail_out = static_cast<uInt>(part.size());
    status = deflate(&stream, text.empty() ? Z_FINISH : Z_NO_FLUSH);
    bytes.append(part, 0, part.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return bytes;
}

std::string beginning_of_gzip(std::string_view bytes) {
  z_stream stream{};
  if (inflateInit2(&stream, MAX_WBITS + container) != Z_OK) throw std::runtime_error("zlib: cannot begin a stream");
  std::string text(beginning, '\0');
  stream.next_in = input_of(bytes);
  stream.avail_in = static_cast<uInt>(std::min(bytes.size(), most));
  stream.next_out = reinterpret_cast<Bytef*>(text.data());
  stream.avail_out = static_cast<uInt>(text.size());
  inflate(&stream, Z_SYNC_FLUSH);  // what it made of the bytes tells, whole or not
  text.resize(text.size() - stream.avail_out);
  inflateEnd(&stream);
  return text;
}

}  // namespace slipbench
