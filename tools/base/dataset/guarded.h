// Reading files that may be damaged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tools/base/dataset/reader.h"

namespace slipbench {

// What reading may take.
struct ReadingLimits {
  std::uint64_t cpu = 0;     // s, of the processor
  std::uint64_t wait = 0;    // s, in all
  std::uint64_t memory = 0;  // bytes, of the address space beyond that of the program
};

// 8 s of the processor and 2 s for each MB of the dataset's files, all shards counted; 120 s and 20 s in all; 8 GB, which two
// copies of the largest record take (run_trial.h), and 16 times the files.
ReadingLimits reading_limits(const std::string& path);

// Runs `action` in a child process and hands back what it returns. HDF5 checks few of the bytes that it reads, so that a damaged
// file can end the process that reads it, or keep it for ever; here that ends the child, and is an InputError "SUBJECT: is
// damaged: ..." or "SUBJECT: cannot be read: ..." with the limit that was reached. A program under a sanitizer has no limit of
// memory. An InputError in the child is thrown again as one, any other exception as std::runtime_error. Call it before any thread
// is made.
std::string guarded(const std::string& subject, const ReadingLimits& limits, const std::function<std::string()>& action);
// With reading_limits(subject): the path of a dataset.
std::string guarded(const std::string& subject, const std::function<std::string()>& action);

// Whether a dataset still holds what was written.

// Compares what the trials hold with their own digests, and their files with content_sha256. A file of schema 1 has its arrays
// checked only, which one line on stderr says; that of a killed run, which has no content_sha256, its trials.
class ContentCheck {
 public:
  // `reader` must outlive the check.
  explicit ContentCheck(const DatasetReader& reader) : reader_(&reader), digests_(reader.files().size()) {}

  // Reads the next trial; they come in ascending order. Throws InputError when it does not hold what was written.
  void add(std::size_t trial);
  // Call after the last trial of a file. Throws InputError when the rest of it does not hold what was written.
  void finish(std::size_t file) const;
  // The same for all files.
  void finish() const;

 private:
  const DatasetReader* reader_;
  std::vector<std::vector<std::pair<std::size_t, Digest>>> digests_;  // by file
};

// A dataset that holds a trial, and whose run came to its end. Throws InputError for another.
DatasetReader whole_dataset(const std::string& path);

// Hands each trial, checked so, to `use`. Throws InputError also where a trial has its outcome alone.
void for_each_trial(const DatasetReader& reader, const std::function<void(const TrialRecord& record)>& use);

// Names of the files of a dataset in their order, read in a child process (guarded). `content`: also compares all that they hold with their
// digests. Throws InputError for what DatasetReader or ContentCheck refuses.
std::vector<std::string> checked_files(const std::string& path, bool content);

// Reads all trials of a file for that.
void check_content(const DatasetReader& reader, std::size_t file);

// What tells a trial from others in whatever file it stands, 64 hexadecimal digits: its attribute `sha256`, or in a file of schema 1,
// which has none, the digest of its arrays.
[[nodiscard]] std::string trial_identity(const DatasetReader& reader, std::size_t trial);

}  // namespace slipbench
