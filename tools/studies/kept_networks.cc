#include "tools/studies/kept_networks.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/process/whole_write.h"

namespace slipbench::reproduce {
namespace {

constexpr std::string_view beginning = "slipbench networks of a study, ";

std::string sha256_of(std::string_view bytes) {
  Sha256 sha;
  sha.update(bytes.data(), bytes.size());
  const Digest digest = sha.finish();
  return {reinterpret_cast<const char*>(digest.data()), digest.size()};
}

std::string first_line(const std::string& of) {
  Sha256 sha;
  sha.update(of.data(), of.size());
  return fmt::format("{}{}\n", beginning, hexadecimal(sha.finish()));
}

[[noreturn]] void fail_to_write(const std::string& path) {
  throw InputError(fmt::format("cannot write {}: {}", path, std::generic_category().message(errno)));
}

std::string bytes_of_file(int file, const std::string& path) {
  struct stat about {};
  if (::fstat(file, &about) != 0) fail_to_write(path);
  std::string bytes(static_cast<std::size_t>(about.st_size), '\0');
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t read = ::pread(file, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    if (read <= 0) throw InputError(path + ": cannot be read");
    at += static_cast<std::size_t>(read);
  }
  return bytes;
}

void append_and_sync(int file, std::string_view bytes, const std::string& path) {
  const off_t end = ::lseek(file, 0, SEEK_END);
  if (end < 0 || !write_whole(file, bytes, static_cast<std::uint64_t>(end)) || !sync_file(file)) fail_to_write(path);
}

struct KeptRecord {
  std::uint64_t set = 0, index = 0;
  std::string_view said;
};
constexpr std::size_t head_bytes = 3 * sizeof(std::uint64_t);  // set, number, size
constexpr std::size_t digest_bytes = std::tuple_size_v<Digest>;

// The record at the beginning of the bytes, which it is taken off; none where it is not whole, as the last one of a run that was killed may be. Throws
// InputError where what follows shows that it once was.
std::optional<KeptRecord> take_record(std::string_view& bytes, const std::string& path) {
  std::array<std::uint64_t, 3> head{};
  if (bytes.size() < head_bytes + digest_bytes) return std::nullopt;
  std::memcpy(head.data(), bytes.data(), head_bytes);
  if (head[2] > bytes.size() - head_bytes - digest_bytes) return std::nullopt;
  const std::string_view body = bytes.substr(0, head_bytes + head[2]);
  if (bytes.substr(body.size(), digest_bytes) != sha256_of(body)) {
    if (body.size() + digest_bytes == bytes.size()) return std::nullopt;
    throw InputError(path + ": is damaged before its last network; allowed: delete the file");
  }
  bytes.remove_prefix(body.size() + digest_bytes);
  return KeptRecord{head[0], head[1], body.substr(head_bytes)};
}

}  // namespace

KeptNetworks::KeptNetworks(std::string path, const std::string& of, bool resume)
    : path_(std::move(path)), file_(lock_file(path_)) {
  const std::string bytes = bytes_of_file(file_.get(), path_), line = first_line(of);
  std::string_view left = bytes;
  if (!bytes.empty() && !bytes.starts_with(beginning))
    throw InputError(fmt::format("{} is there and holds no networks of a study; allowed: another name of -o", path_));
  if (resume && !bytes.empty() && !bytes.starts_with(line)) {
    throw InputError(fmt::format(
        "{} is of other options, data, scenes or another build of the program; allowed: with --resume the same command again, or delete the file",
        path_));
  }
  left.remove_prefix(std::min(left.size(), line.size()));
  while (const std::optional<KeptRecord> one = take_record(left, path_)) said_[{one->set, one->index}] = one->said;
  if (!resume && !said_.empty()) {
    throw InputError(
        fmt::format("{} holds {} networks of a run that did not come to its end; allowed: --resume, or delete the file", path_,
                    said_.size()));
  }
  const std::size_t whole = bytes.starts_with(line) ? bytes.size() - left.size() : 0;
  if (::ftruncate(file_.get(), static_cast<off_t>(whole)) != 0) fail_to_write(path_);
  if (whole == 0) append_and_sync(file_.get(), line, path_);
}

KeptNetworks::~KeptNetworks() {
  if (said_.empty()) remove();
}

const std::string* KeptNetworks::find(std::size_t index) const {
  const auto found = said_.find({set_, index});
  return found == said_.end() ? nullptr : &found->second;
}

void KeptNetworks::keep(std::size_t index, const std::string& said) {
  const std::array<std::uint64_t, 3> head{set_, index, said.size()};
  std::string record(head_bytes, '\0');
  std::memcpy(record.data(), head.data(), head_bytes);
  record += said;
  record += sha256_of(record);
  append_and_sync(file_.get(), record, path_);
  said_[{set_, index}] = said;
}

void KeptNetworks::remove() { static_cast<void>(::unlink(path_.c_str())); }

}  // namespace slipbench::reproduce
