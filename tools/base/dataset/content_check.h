// Whether a dataset still holds what was written.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "tools/base/dataset/reader.h"

namespace slipbench {

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

// Reads all trials for that.
void check_content(const DatasetReader& reader);

// What tells a trial from others in whatever file it stands, 64 hexadecimal digits: its attribute `sha256`, or in a file of schema 1,
// which has none, the digest of its arrays.
[[nodiscard]] std::string trial_identity(const DatasetReader& reader, std::size_t trial);

}  // namespace slipbench
