// Whether a dataset still holds what was written.
#pragma once

#include <vector>

#include "tools/base/dataset/encoder.h"
#include "tools/base/dataset/reader.h"

namespace slipbench {

// Compares the arrays of trials, as they are read anyway, with the content_sha256 of their files.
class ContentCheck {
 public:
  // `reader` must outlive the check.
  explicit ContentCheck(const DatasetReader& reader) : reader_(&reader), digests_(reader.files().size()) {}

  // Takes the next trial; they come in ascending order.
  void add(const TrialRecord& record) { digests_[reader_->file_of(record.trial)].push_back(trial_digest(record)); }
  // Call after the last trial of a file. Throws InputError when it does not hold what was written. A file without a digest, that of
  // a killed run, is not judged.
  void finish(std::size_t file) const;
  // The same for all files.
  void finish() const;

 private:
  const DatasetReader* reader_;
  std::vector<std::vector<Digest>> digests_;  // by file
};

// Reads all trials of a file for that.
void check_content(const DatasetReader& reader, std::size_t file);

}  // namespace slipbench
