#include "tools/base/dataset/content_check.h"

#include <fmt/format.h>

#include "sim/core/error.h"

namespace slipbench {

void ContentCheck::finish(std::size_t file) const {
  const std::string& written = reader_->content_sha256()[file];
  if (written.empty()) return;
  const std::string found = content_digest(digests_[file]);
  if (found == written) return;
  throw InputError(fmt::format("{}: is damaged: its arrays have the SHA-256 {}, content_sha256 says {}", reader_->files()[file],
                               found, written));
}

void ContentCheck::finish() const {
  for (std::size_t file = 0; file < digests_.size(); ++file) finish(file);
}

void check_content(const DatasetReader& reader, std::size_t file) {
  if (reader.content_sha256()[file].empty()) return;
  ContentCheck check(reader);
  for (const std::size_t trial : reader.trials()) {
    if (reader.file_of(trial) == file) check.add(reader.read_trial(trial));
  }
  check.finish(file);
}

}  // namespace slipbench
