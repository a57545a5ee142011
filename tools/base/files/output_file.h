// Files and folders of ours: written whole, for the time being, or locked.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

struct evp_md_ctx_st;

namespace slipbench {

// A kind of text file that the program makes, told by its beginning from the files of others.
struct TextKind {
  std::string_view name;                                   // "report"
  std::function<bool(std::string_view beginning)> begins;  // of the file's first 4 kB
};

// Throws InputError when a file cannot be put at `path`: no file name, a folder, a special file, a symbolic link (which would be
// replaced, not followed), a read-only file, a missing folder.
void check_target(const std::string& path);

// The same for a text file made from `inputs` and written by write_text_file, and for the name that it has while it is written.
// Refuses besides the inputs themselves, and whatever holds something and does not begin as such a file.
void check_text_target(const std::string& path, const std::vector<std::string>& inputs, const TextKind& kind);

// The name of a file while it is written: OUT.h5.partial.
std::string temporary_path(const std::string& path);

// Throws InputError with the system's reason.
void rename_file(const std::string& from, const std::string& to);

// Makes names in the folder of `path` survive a power failure. Throws InputError with the system's reason.
void sync_folder_of(const std::string& path);

// Writes `text` to PATH.partial, syncs it and renames it. Throws InputError when that is not possible; then nothing is left
// behind. Call check_text_target before.
void write_text_file(const std::string& path, const std::string& text);

// A folder for what a command needs only while it runs.

// Empty at first, in the system's folder for temporary files; removed with its object. Throws InputError where it cannot be made.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  // The path of `name` in it.
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

// Files that one run at a time writes.

// An open descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int value = -1) : value_(value) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  [[nodiscard]] int get() const { return value_; }

 private:
  int value_;
};

// Opens the file for reading and writing, makes it where there is none, and locks it against other runs for as long as the
// descriptor lives. Throws InputError, "cannot write PATH: another run is writing it" or with the system's reason.
Descriptor lock_file(const std::string& path);

// SHA-256, by OpenSSL.

using Digest = std::array<std::uint8_t, 32>;

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(const void* bytes, std::size_t size);
  // The digest of all that was given; the object then begins anew.
  Digest finish();

 private:
  evp_md_ctx_st* context_;
};

// 64 hexadecimal digits.
std::string hexadecimal(const Digest& digest);

}  // namespace slipbench
