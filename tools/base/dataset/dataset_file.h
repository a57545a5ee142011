// One file of a dataset while it is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/stored_trial.h"
#include "tools/base/files/output_file.h"
#include "tools/base/hdf5/hdf5_place.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

// Writes one HDF5 file. All functions throw InputError "cannot write PATH: reason of the system"; the file is then removed and nothing
// but the destructor may be called.
class DatasetFile {
 public:
  // Makes the file anew. `index`: its number in the dataset.
  DatasetFile(std::string path, const DatasetHeader& header, std::size_t index);
  // Removes a file that was not finished.
  ~DatasetFile();
  DatasetFile(const DatasetFile&) = delete;
  DatasetFile& operator=(const DatasetFile&) = delete;

  // Adds a trial. Trials come in ascending order.
  void append(const EncodedTrial& trial);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<StoredTrial>& trials() const { return trials_; }
  // Upper bound of what the trials take in the file [bytes]. It depends on nothing but them, so that the undivided sweep and its merged
  // shards are cut into the same files.
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }

  // Closes a file that gets no further trial, so that it takes no memory until finish().
  void pause();
  // Ends a batch: adds the trials' groups and the digest, closes and syncs.
  void finish_batch();
  // Ends a file of a dataset: adds masks, what has failed and the digest, closes and syncs. `files`: of the whole dataset.
  void finish(const Masks& masks, const std::vector<FailedTrial>& failed, std::size_t files);

 private:
  // Runs `action`; what it throws is a failure of this file.
  template <class Action>
  void write(const Action& action);
  void write_digest();
  void close();
  void remove();

  std::string path_;
  Descriptor descriptor_;  // for syncing: opened before anything is written, it reports every failure
  hdf5::Handle file_;
  hdf5::Handle list_;  // the group of the trials
  bool finished_ = false;
  bool of_sweep_shard_;  // its masks are not final: what they are made from is kept beside them
  std::optional<SplitRule> split_;
  std::vector<StoredTrial> trials_;
  std::uint64_t bytes_ = 0;
};

// Attribute of /mask of a sweep's shard: the shares that the scene's split gives.
inline constexpr const char* split_shares_name = "shares";

// Upper bound of what a trial takes in a file [bytes].
std::uint64_t file_bytes(const EncodedTrial& trial);
// The same of masks and attributes that a file of so many trials gets when it is finished, without the groups of a sweep's shard.
std::uint64_t closing_bytes(std::size_t trials);

}  // namespace slipbench
