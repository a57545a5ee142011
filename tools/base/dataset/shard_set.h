// Several shards of one sweep, as they lie in files.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tools/base/dataset/header.h"
#include "tools/base/record/encoder.h"

namespace slipbench {

class StoredTrials;

// Shards that belong together. A shard may stand there twice, and two may hold the same trial, as long as its digests are equal or its
// numbers within the rounding of libraries of others (trial_difference.h).
class ShardSet {
 public:
  // `paths`: the first files of shards; further files of them may stand among them. Throws InputError as StoredTrials does, and for a shard of
  // another sweep than the first one's, with what differs: scene, seed, version, overrides, command, files, n.
  explicit ShardSet(const std::vector<std::string>& paths);
  ~ShardSet();
  ShardSet(const ShardSet&) = delete;
  ShardSet& operator=(const ShardSet&) = delete;

  // Of the first shard.
  [[nodiscard]] const DatasetHeader& header() const;
  // Names of the shards' first files, and of all files.
  [[nodiscard]] std::vector<std::string> paths() const;
  [[nodiscard]] std::vector<std::string> files() const;
  // The trials of all shards (number, group), ascending; those that several hold stand there several times.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::string>> list();
  // Different trials that the shards hold.
  [[nodiscard]] std::size_t size() const { return count_; }
  // Trials that failed, ascending.
  [[nodiscard]] std::vector<FailedTrial> failed() const;
  // What is missing, as clauses: "shards 3 and 7 of 8 are missing", "trial 12 is missing". Empty: the sweep is whole.
  [[nodiscard]] const std::vector<std::string>& gaps() const { return gaps_; }

  // The next trial, in ascending order over all shards; empty: there is none. Adds to `duplicates` how many further shards hold it. Throws
  // InputError where they do not agree.
  std::optional<EncodedTrial> next(std::size_t& duplicates);
  // Does the same to all trials without reading them. Returns how often a further shard holds one.
  std::size_t check_duplicates();
  // Further trials among them so far whose digest is another one: they were compared number by number.
  [[nodiscard]] std::size_t within_rounding() const { return within_rounding_; }

 private:
  // The shards that stand at the lowest trial. Throws where they do not agree.
  std::vector<StoredTrials*> at_least();
  void look_for_gaps();

  std::vector<std::unique_ptr<StoredTrials>> shards_;
  std::map<std::size_t, FailedTrial> failed_;
  std::size_t count_ = 0;
  std::size_t within_rounding_ = 0;
  std::vector<std::string> gaps_;
};

// The shards of a sweep put together.
struct Merged {
  std::size_t trials = 0;           // in `files`
  std::size_t failed = 0;           // trials that no shard could simulate
  std::size_t duplicates = 0;       // trials that several of the files hold
  std::size_t within_rounding = 0;  // of these, with another digest and numbers within the rounding of libraries of others
  std::vector<std::string> files;
};

// Writes the dataset that the undivided sweep would have written, byte for byte, from the shards `paths` (their first files; further ones may
// stand among them). Chunks are copied as they lie there. Throws InputError, and writes nothing, where a file is no whole shard, where one is of
// another sweep, where trials are missing, where two files hold a trial on which they do not agree, and where `output` cannot be written. What a
// killed merge has left of `output` is replaced.
Merged merge_shards(const std::vector<std::string>& paths, const std::string& output);

}  // namespace slipbench
