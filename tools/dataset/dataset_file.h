// Writes one file of a dataset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/header.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/stored_trial.h"
#include "tools/files/output_file.h"

namespace slipbench {

// Writes one HDF5 file. All functions throw InputError "cannot write PATH: reason of the
// system"; the file is then removed, and only the destructor may be called.
class DatasetFile {
 public:
  // Creates the file. `index`: its number in the dataset.
  DatasetFile(std::string path, const DatasetHeader& header, std::size_t index);
  // Removes a file that was not finished.
  ~DatasetFile();
  DatasetFile(const DatasetFile&) = delete;
  DatasetFile& operator=(const DatasetFile&) = delete;

  // Adds a trial. Trials come in ascending order.
  void append(const EncodedTrial& trial);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<StoredTrial>& trials() const { return trials_; }
  // Upper bound of the space of the trials in the file [bytes]. It depends on the trials alone, so
  // that the undivided sweep and its merged shards are split into the same files.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

  // Closes the file until finish() to free its memory. No trial may follow.
  void pause();
  // Finishes a batch: adds the trials' groups and the digest, closes and syncs.
  void finish_batch();
  // Finishes a file of a dataset: adds masks, failed trials and the digest, closes and syncs.
  // `files`: number of files of the whole dataset.
  void finish(const Masks& masks, const std::vector<FailedTrial>& failed, std::size_t files);

 private:
  // Runs `action` and reports its exception as a failure of this file.
  template <class Action>
  void write(const Action& action);
  void write_digest();
  void close();
  void remove();

  std::string path_;
  Descriptor descriptor_;  // for syncing; opened before the first write, so it reports every failure
  hdf5::Handle file_;
  hdf5::Handle list_;  // the group of the trials
  bool finished_ = false;
  bool of_sweep_shard_;  // stores the groups and the split rule: a shard's masks are not final
  std::optional<SplitRule> split_;
  std::vector<StoredTrial> trials_;
  std::uint64_t bytes_ = 0;
};

// Attribute of /mask in a shard of a sweep: the shares of the scene's split.
inline constexpr const char* split_shares_name = "shares";

// Upper bound of the space of a trial in a file [bytes].
std::uint64_t file_bytes(const EncodedTrial& trial);
// Upper bound [bytes] of the masks and attributes that finish() adds to a file of `trials` trials,
// without the groups in a shard of a sweep.
std::uint64_t closing_bytes(std::size_t trials);

}  // namespace slipbench
