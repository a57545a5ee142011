// One file of a dataset while it is written.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/files/output_file.h"
#include "tools/base/hdf5/crash_safe_file.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

// Writes one HDF5 file. Two locks of the process on one path cannot be had, so that two runs never mix. A file whose writing has
// failed once is left as it was when it was published last. Throws InputError with the system's reason.
class Shard {
 public:
  // `planned`: demos that will come, if they all fit. `last`: the highest number that one of them may have.
  Shard(std::string temporary, const DatasetHeader& header, std::size_t index, std::size_t planned, std::size_t last);
  ~Shard();
  Shard(Shard&&) noexcept = default;
  Shard& operator=(Shard&&) noexcept = default;

  // Adds a demo. Until publish() a killed run leaves the file without it.
  void append(const EncodedTrial& trial);
  // All demos so far are in the file for good, whatever happens to the process or to the machine's power. Costs two syncs of the
  // disk.
  void publish();

  // Publishes a file that gets no further demo, and lets go of a megabyte of memory and of all that HDF5 has open. prepare() opens it again.
  void park();

  // Numbers of the trials held.
  [[nodiscard]] const std::vector<std::size_t>& trials() const { return trials_; }
  // How many of them are in the file for good.
  [[nodiscard]] std::size_t published() const { return published_; }
  // Bytes of the file if it were closed now.
  [[nodiscard]] std::uint64_t size_bytes() const;
  // Whether a write has failed.
  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  // Publishes, and writes the attributes and masks of the whole, which nobody sees before close(). `shards`: number of files of
  // the dataset. `complete`: whether the run came to its end. Nothing can be appended any more.
  void prepare(const Masks& masks, const std::vector<FailedTrial>& failed, std::size_t shards, bool complete);
  [[nodiscard]] bool prepared() const { return prepared_; }
  // Shows what was prepared, which takes no further space, and closes and syncs the file.
  void close();

 private:
  // Runs `action`; what it throws is a failure of this file.
  template <class Action>
  void write(const Action& action);

  std::string path_;
  Descriptor descriptor_;  // holds the lock, and is what is written through
  hdf5::CrashSafeFile file_;
  bool parked_ = false;
  hdf5::Handle list_;           // the group of the demos
  std::size_t list_bytes_ = 0;  // of its header
  bool of_shard_;               // of a sweep: masks are then no last word, and what they are made from is kept
  std::optional<SplitRule> split_;
  std::vector<std::string> groups_;  // of the trials; only of a sweep's shard
  std::vector<std::size_t> trials_;
  std::size_t published_ = 0;
  bool prepared_ = false;
  std::vector<Digest> digests_;
  bool failed_ = false;
};

// Name of the array of /mask that holds the groups of a shard's trials, and of its attribute with the shares that the scene's split gives.
inline constexpr const char* split_groups_name = "group";
inline constexpr const char* split_shares_name = "shares";

// What a demo takes in a file beside its chunks, from above [bytes].
std::uint64_t overhead_bytes(const EncodedTrial& trial);

}  // namespace slipbench
