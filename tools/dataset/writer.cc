#include "tools/dataset/writer.h"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "tools/dataset/dataset_file.h"
#include "tools/dataset/dataset_target.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/stored_trials.h"

namespace slipbench {

DatasetWriter::DatasetWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit)
    : own_folder_(std::make_unique<RunFolder>(path)),
      folder_(*own_folder_),
      header_(std::move(header)),
      shard_limit_(shard_limit) {
  check_dataset_target(path);
  folder_.refuse_batches();
}

DatasetWriter::DatasetWriter(const RunFolder& folder, DatasetHeader header, std::uint64_t shard_limit)
    : folder_(folder), header_(std::move(header)), shard_limit_(shard_limit) {}

DatasetWriter::~DatasetWriter() = default;

void DatasetWriter::append(const EncodedTrial& trial) {
  longest_group_ = std::max(longest_group_, trial.material.size());
  const DatasetFile* const last = files_.empty() ? nullptr : files_.back().get();
  bool full = last == nullptr;
  if (last != nullptr) {
    const std::size_t held = last->trials().size();
    if (trial.trial <= last->trials().back().number)
      throw std::logic_error(fmt::format("trial {} after trial {}", trial.trial, last->trials().back().number));
    const std::uint64_t groups = header_.part ? (held + 1) * longest_group_ : 0;
    full = last->bytes() + file_bytes(trial) + closing_bytes(held + 1) + groups > shard_limit_;
    if (full) files_.back()->pause();
  }
  if (full) files_.push_back(std::make_unique<DatasetFile>(folder_.unfinished_file(files_.size()), header_, files_.size()));
  files_.back()->append(trial);
}

void DatasetWriter::adopt(std::unique_ptr<DatasetFile> file) { files_.push_back(std::move(file)); }

void DatasetWriter::add_failed(FailedTrial failed) { failed_.push_back(std::move(failed)); }

std::size_t DatasetWriter::size() const {
  std::size_t count = 0;
  for (const auto& file : files_) count += file->trials().size();
  return count;
}

std::vector<std::string> DatasetWriter::commit() {
  const std::string& target = folder_.target();
  for (std::size_t k = 1; k < files_.size(); ++k) check_dataset_target(target, k);
  if (files_.empty()) files_.push_back(std::make_unique<DatasetFile>(folder_.unfinished_file(0), header_, 0));
  std::vector<std::pair<std::size_t, std::string>> trials;
  for (const auto& file : files_) {
    for (const StoredTrial& trial : file->trials()) trials.emplace_back(trial.number, trial.group);
  }
  const Masks masks = split_trials(trials, header_.seed, header_.split);
  for (const auto& file : files_) file->finish(masks, failed_, files_.size());

  const std::vector<std::string> stale = later_files(target, files_.size());
  std::vector<std::string> names;
  for (std::size_t k = files_.size(); k-- > 0;) {
    rename_file(files_[k]->path(), shard_path(target, k));
    names.insert(names.begin(), shard_path(target, k));
  }
  for (const std::string& name : stale) ::unlink(name.c_str());
  sync_folder_of(target);
  files_.clear();
  if (own_folder_) own_folder_->close();
  return names;
}

void copy_trials(const std::vector<StoredTrial>& trials, DatasetWriter& writer, const std::atomic<bool>* interrupt) {
  constexpr std::size_t most_open = 64;
  std::map<std::string, hdf5::Handle> files;
  for (const StoredTrial& trial : trials) {
    end_if(interrupt);
    if (!files.contains(trial.file)) {
      if (files.size() == most_open) files.clear();
      const hdf5::Handle& file = files[trial.file] = hdf5::open_file(trial.file);
      hdf5::keep_little(file);
    }
    writer.append(read_encoded(files.at(trial.file).get(), trial));
  }
}

}  // namespace slipbench
