// Checks a dataset against the digests that were written with it.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tools/dataset/reader.h"

namespace slipbench {

// Compares the trials with their own digests, and their files with content_sha256. In a file of
// schema 1 only the arrays are checked, which one line on stderr states; in a file of a killed run,
// which has no content_sha256, only the trials.
class ContentCheck {
 public:
  // `reader` must outlive the check.
  explicit ContentCheck(const DatasetReader& reader) : reader_(&reader), digests_(reader.files().size()) {}

  // Reads the next trial, in ascending order. Throws InputError if its content does not match its
  // digest.
  void add(std::size_t trial);
  // Call after the last trial of a file. Throws InputError if the file does not match its digest.
  void finish(std::size_t file) const;
  // As above, for all files.
  void finish() const;

 private:
  const DatasetReader* reader_;
  std::vector<std::vector<std::pair<std::size_t, Digest>>> digests_;  // by file
};

// Checks all trials and files of a dataset by ContentCheck.
void check_content(const DatasetReader& reader);

// Identity of a trial, independent of the file that holds it, as 64 hexadecimal digits: its
// attribute `sha256`, or in a file of schema 1, which has no such attribute, the digest of its
// arrays.
[[nodiscard]] std::string trial_identity(const DatasetReader& reader, std::size_t trial);

}  // namespace slipbench
