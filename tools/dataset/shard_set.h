// Reads and merges the shards of one sweep.
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "tools/dataset/header.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/record/json.h"
#include "tools/dataset/stored_trial.h"

namespace slipbench {

// Shards of one sweep. A shard may be given twice, and two files may hold the same trial if its
// digests are equal or its numbers differ only by the rounding of third-party libraries
// (trial_difference.h).
class ShardSet {
 public:
  // `paths`: the first files of shards, and optionally their further files. Throws InputError for a
  // file that is not a shard of a sweep or whose run did not finish; for a shard of another sweep
  // than the first one's, stating what differs (scene, seed, version, overrides, command, files,
  // n); and if two files disagree on a trial.
  explicit ShardSet(const std::vector<std::string>& paths);

  // Header of the first shard, with the scene's split.
  [[nodiscard]] const DatasetHeader& header() const { return shards_.front().about.header; }
  // Names of the shards' first files, and of all files.
  [[nodiscard]] std::vector<std::string> paths() const;
  [[nodiscard]] std::vector<std::string> files() const;
  // The distinct trials of the shards, ascending.
  [[nodiscard]] std::vector<StoredTrial> trials() const;
  // Number of distinct trials, and number of further copies of them.
  [[nodiscard]] std::size_t size() const { return trials_.size(); }
  [[nodiscard]] std::size_t duplicates() const { return duplicates_; }
  // Number of duplicates with a different digest whose numbers differ only by the rounding of
  // third-party libraries.
  [[nodiscard]] std::size_t within_rounding() const { return within_rounding_; }
  // Trials that failed, ascending.
  [[nodiscard]] std::vector<FailedTrial> failed() const;
  // Missing parts, as clauses: "shards 3 and 7 of 8 are missing", "trial 12 is missing". Empty if
  // the sweep is complete.
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

// Result of merge_shards().
struct Merged {
  std::size_t trials = 0;           // number in `files`
  std::size_t failed = 0;           // trials that no shard could simulate
  std::size_t duplicates = 0;       // trials in several of the files
  std::size_t within_rounding = 0;  // duplicates that differ only by the rounding of third-party libraries
  std::vector<std::string> files;
};

// Merges the shards `paths` (their first files, and optionally further ones) to the dataset that
// the undivided sweep would have written, with its digests. Chunks are copied without
// decompression. Throws InputError, and writes nothing, if a file is not a complete shard or is
// damaged, if it belongs to another sweep, if trials are missing, if two files disagree on a trial,
// and if `output` cannot be written; Interrupted once `interrupt`, which may be null, is true.
Merged merge_shards(const std::vector<std::string>& paths, const std::string& output,
                    const std::atomic<bool>* interrupt = nullptr);

// The result as `slipbench merge --json` prints it.
Json merged_json(const Merged& merged);

}  // namespace slipbench
