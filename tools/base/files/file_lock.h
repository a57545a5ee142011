// Files that one run at a time writes.
#pragma once

#include <string>
#include <utility>

namespace slipbench {

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

}  // namespace slipbench
