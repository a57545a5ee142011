#include "tools/dataset/content_check.h"

#include <cstdio>

#include "tools/files/reject.h"

namespace slipbench {

void ContentCheck::add(std::size_t trial) {
  const std::size_t file = reader_->file_of(trial);
  const Digest found = reader_->stored_digest(trial);
  const std::string written = reader_->trial_sha256(trial);
  if (reader_->schema(file) > 1 && hexadecimal(found) != written) {
    reject("{}: /data/demo_{}: is damaged: its content has the SHA-256 {}, but its attribute sha256 is {}",
           reader_->files()[file], trial, hexadecimal(found), written);
  }
  digests_[file].emplace_back(trial, found);
}

void ContentCheck::finish(std::size_t file) const {
  const std::string& written = reader_->content_sha256()[file];
  if (reader_->schema(file) == 1) {
    std::fprintf(
        stderr,
        "slipbench: %s: schema 1: its digest covers only the arrays, so attributes such as onset_time_s are not checked\n",
        printable(reader_->files()[file]).c_str());
  }
  if (written.empty()) return;
  const std::string found = reader_->stored_sha256(file, digests_[file]);
  if (found == written) return;
  reject("{}: is damaged: its content has the SHA-256 {}, but content_sha256 is {}", reader_->files()[file], found, written);
}

void ContentCheck::finish() const {
  for (std::size_t file = 0; file < digests_.size(); ++file) finish(file);
}

void check_content(const DatasetReader& reader) {
  ContentCheck check(reader);
  for (const std::size_t trial : reader.trials()) check.add(trial);
  check.finish();
}

std::string trial_identity(const DatasetReader& reader, std::size_t trial) {
  const std::string written = reader.trial_sha256(trial);
  return written.empty() ? hexadecimal(reader.stored_digest(trial)) : written;
}

}  // namespace slipbench
