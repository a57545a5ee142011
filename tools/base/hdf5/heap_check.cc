#include "tools/base/hdf5/heap_check.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <hdf5.h>

#include "sim/core/error.h"

namespace slipbench {
namespace {

using Bytes = std::span<const std::uint8_t>;

// A file's bytes, mapped for as long as the object lives.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    const bool found = descriptor >= 0 && ::fstat(descriptor, &status) == 0;
    void* address =
        found ? ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_PRIVATE, descriptor, 0) : MAP_FAILED;
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    if (address == MAP_FAILED) throw InputError(fmt::format("{}: cannot be read: {}", path, std::strerror(reason)));
    bytes_ = {static_cast<const std::uint8_t*>(address), static_cast<std::size_t>(status.st_size)};
  }
  ~MappedFile() { ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size()); }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  [[nodiscard]] Bytes bytes() const { return bytes_; }
  // Gives back the memory of a part, which is read again when it is asked for. `from`: a multiple of the page.
  void let_go(std::size_t from, std::size_t count) const {
    ::madvise(const_cast<std::uint8_t*>(bytes_.data()) + from, std::min(count, bytes_.size() - from), MADV_DONTNEED);
  }

 private:
  Bytes bytes_;
};

template <class T>
T number_at(Bytes bytes, std::size_t place) {
  T value{};
  std::memcpy(&value, bytes.data() + place, sizeof value);
  return value;
}

// HDF5 file format 3.0, III.E: signature, version and size; then objects of index, count of references and size, each padded to
// 8 bytes. Index 0 is the free rest, whose size includes its header. The writer numbers the others from 1 on. HDF5 1.14 leaves gaps where a text was
// changed, and finds an index that is not there by itself; 1.10 reads from nowhere.
constexpr bool gaps_are_sound = H5_VERSION_GE(1, 14, 0);

bool sound_heap(Bytes rest) {
  constexpr std::size_t header = 16;
  if (rest.size() < header) return false;
  const auto size = number_at<std::uint64_t>(rest, 8);
  if (size < header || size > rest.size()) return false;
  std::uint16_t last = 0;
  for (std::size_t place = header; place + header <= size;) {
    const auto index = number_at<std::uint16_t>(rest, place);
    const auto length = number_at<std::uint64_t>(rest, place + 8);
    const std::uint64_t left = size - place;
    if (length > left) return false;
    if (index == 0) return length == left;
    if (index != last + 1 && !gaps_are_sound) return false;
    const std::uint64_t needed = header + (length + 7) / 8 * 8;
    if (needed > left) return false;
    last = index;
    place += needed;
  }
  return true;
}

}  // namespace

void check_heaps(const std::string& path) {
  using namespace std::string_view_literals;
  constexpr std::string_view start = "GCOL\x01\0\0\0"sv;  // signature, version, reserved
  const MappedFile file(path);
  const std::string_view text(reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size());
  constexpr std::size_t window = 16 << 20;  // bytes that are in memory at a time
  for (std::size_t from = 0; from < text.size(); from += window) {
    const std::string_view part = text.substr(from, window + start.size() - 1);
    for (std::size_t place = part.find(start); place != std::string_view::npos; place = part.find(start, place + start.size())) {
      if (!sound_heap(file.bytes().subspan(from + place))) {
        throw InputError(fmt::format("{}: is damaged: the texts at byte {} are not as they were written", path, from + place));
      }
    }
    file.let_go(from, window);
  }
}

}  // namespace slipbench
