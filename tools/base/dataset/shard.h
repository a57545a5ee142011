// One file of a dataset while it is written.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tools/base/dataset/encoder.h"
#include "tools/base/dataset/hdf5_handle.h"
#include "tools/base/dataset/header.h"
#include "tools/base/dataset/mask.h"

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

// Writes one HDF5 file. Two locks of the process on one path cannot be had, so that two runs never mix. A file whose writing has
// failed once is left as it was after the last trial that succeeded. Throws InputError with the system's reason.
class Shard {
 public:
  // `planned`: demos that will come, if they all fit.
  Shard(std::string temporary, const DatasetHeader& header, std::size_t index, std::size_t planned);
  ~Shard();
  Shard(Shard&&) noexcept = default;
  Shard& operator=(Shard&&) noexcept = default;

  // Adds a demo. When it returns the demo is in the file for good; until then a killed run leaves the file without it: the demo
  // is written in space that nothing refers to yet, and then listed by rewriting one block.
  void append(const EncodedTrial& trial);

  // Numbers of the trials held.
  [[nodiscard]] const std::vector<std::size_t>& trials() const { return trials_; }
  // Bytes of the file if it were closed now.
  [[nodiscard]] std::uint64_t size_bytes() const;
  // Whether a write has failed.
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  // Writes the attributes and masks of the whole, closes and syncs. `shards`: number of files of the dataset. `complete`: whether
  // the run came to its end.
  void finish(const Masks& masks, std::size_t shards, bool complete);

 private:
  void write_demo(const EncodedTrial& trial);
  void flush();

  std::string path_;
  Descriptor descriptor_;  // holds the lock, and is what fsync needs
  hdf5::Handle file_;
  std::vector<std::size_t> trials_;
  std::vector<Digest> digests_;
  bool failed_ = false;
};

// What a demo takes in a file beside its chunks, from above [bytes].
std::uint64_t overhead_bytes(const EncodedTrial& trial);

}  // namespace slipbench
