// Several shards of one sweep, as they lie in files.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/dataset/stored_trial.h"

namespace slipbench {

// Shards that belong together. A shard may be given twice, and two may hold the same trial, as long as its digests are equal or its
// numbers within the rounding of libraries of others (trial_difference.h).
class ShardSet {
 public:
  // `paths`: the first files of shards; further files of them may be among them. Throws InputError for a file that is not a shard of a sweep
  // or whose run did not come to its end, for a shard of another sweep than the first one's, with what differs (scene, seed, version,
  // overrides, command, files, n), and where two files hold a trial on which they do not agree.
  explicit ShardSet(const std::vector<std::string>& paths);

  // Of the first shard, with the scene's split.
  [[nodiscard]] const DatasetHeader& header() const { return shards_.front().about.header; }
  // Names of the shards' first files, and of all files.
  [[nodiscard]] std::vector<std::string> paths() const;
  [[nodiscard]] std::vector<std::string> files() const;
  // The different trials that the shards hold, ascending.
  [[nodiscard]] std::vector<StoredTrial> trials() const;
  // Number of different trials, and how often a further file holds one of them.
  [[nodiscard]] std::size_t size() const { return trials_.size(); }
  [[nodiscard]] std::size_t duplicates() const { return duplicates_; }
  // How many of these have another digest and numbers within the rounding of libraries of others.
  [[nodiscard]] std::size_t within_rounding() const { return within_rounding_; }
  // Trials that failed, ascending.
  [[nodiscard]] std::vector<FailedTrial> failed() const;
  // What is missing, as clauses: "shards 3 and 7 of 8 are missing", "trial 12 is missing". Empty: the sweep is whole.
  [[nodiscard]] std::vector<std::string> gaps() const;

 private:
  struct Shard {
    std::string path;
    FileAbout about;
    std::vector<std::string> files;
  };

  void add_shard(const std::string& path, FileAbout about);
  void add_trials(const Shard& shard);
  void check_same_sweep(const Shard& shard) const;

  std::vector<Shard> shards_;
  std::map<std::size_t, StoredTrial> trials_;
  std::size_t duplicates_ = 0;
  std::size_t within_rounding_ = 0;
  std::map<std::size_t, FailedTrial> failed_;
};

// The shards of a sweep put together.
struct Merged {
  std::size_t trials = 0;           // in `files`
  std::size_t failed = 0;           // trials that no shard could simulate
  std::size_t duplicates = 0;       // trials that several of the files hold
  std::size_t within_rounding = 0;  // of these, with another digest and numbers within the rounding of libraries of others
  std::vector<std::string> files;
};

// Writes the dataset that the undivided sweep would have written, with its digests, from the shards `paths` (their first files; further ones
// may be among them). Chunks are copied as they are compressed. Throws InputError, and writes nothing, where a file is not a whole shard or
// is damaged, where one is of another sweep, where trials are missing, where two files hold a trial on which they do not agree, and where
// `output` cannot be written.
Merged merge_shards(const std::vector<std::string>& paths, const std::string& output);

}  // namespace slipbench
