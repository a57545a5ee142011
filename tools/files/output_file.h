// Output files and folders: written atomically, temporary, or locked.
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

// A kind of text file that the program writes, recognised by its first bytes.
struct TextKind {
  std::string_view name;                                   // "report"
  std::function<bool(std::string_view beginning)> begins;  // of the file's first 4 kB
};

// Throws InputError if a file cannot be written at `path`: no file name, a folder, a special file,
// a symbolic link (which would be replaced, not followed), a read-only file, a missing folder.
void check_target(const std::string& path);

// As check_target(), for a text file made from `inputs` and written by write_text_file(), and for
// its temporary name. Also refuses the inputs themselves and any non-empty file that is not of that
// kind.
void check_text_target(const std::string& path, const std::vector<std::string>& inputs, const TextKind& kind);

// Temporary name of a file that is being written: OUT.h5.partial.
std::string temporary_path(const std::string& path);

// Renames a file. Throws InputError with the system's reason.
void rename_file(const std::string& from, const std::string& to);

// Syncs the folder of `path`, so that names in it survive a power failure. Throws InputError with
// the system's reason.
void sync_folder_of(const std::string& path);

// Writes `text` to PATH.partial, syncs it and renames it. Throws InputError on failure; then no
// file remains. A signal that ends the program waits until then (DelayedEnd). Call check_text_target() first.
void write_text_file(const std::string& path, const std::string& text);

// The same for several files, paths and their texts: they get their names together once all are
// complete, so that on a full disk none of them remains.
void write_text_files(const std::vector<std::pair<std::string, std::string>>& files);

// Temporary folder of a command.

// Created empty in the system's folder for temporary files; removed with this object. Throws
// InputError if it cannot be created.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  // Path of `name` in the folder.
  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
};

// Files that only one run at a time may write.

// Owns a file descriptor and closes it.
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

// Opens the file for reading and writing, creates it if necessary, and locks it against other runs
// for the lifetime of the descriptor. Throws InputError, "cannot write PATH: another run is writing
// it" or with the system's reason.
Descriptor lock_file(const std::string& path);

// SHA-256 by OpenSSL.

using Digest = std::array<std::uint8_t, 32>;

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void update(const void* bytes, std::size_t size);
  // Digest of all bytes since the last finish(); the object then starts anew.
  Digest finish();

 private:
  evp_md_ctx_st* context_;
};

// The digest as 64 hexadecimal digits.
std::string hexadecimal(const Digest& digest);

}  // namespace slipbench
