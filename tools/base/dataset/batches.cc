#include "tools/base/dataset/batches.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"
#include "tools/base/dataset/dataset_file.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/dataset/stored_trials.h"
#include "tools/base/files/reject.h"

namespace slipbench {
namespace {

[[noreturn]] void refuse_other_run(const std::string& path, const std::string& name, const std::string& difference) {
  reject(
      "cannot resume {}: {} was written by another run: {}; allowed: the same scene, seed, version, overrides, command and files",
      path, name, difference);
}

// How the run that wrote `name` differs from this one; empty: not at all. Damage counts as no difference.
std::string difference_of(const std::string& name, const DatasetHeader& header) {
  try {
    check_readable(FileKind::dataset_file, name);
    const std::optional<FileAbout> about = file_about(name);
    return about ? header_difference(about->header, header) : "it is no dataset";
  } catch (const InputError&) {
    return "";
  }
}

// The trials of a batch; hands what is read of each to `use`. Throws InputError where a trial does not hold its digest.
std::vector<StoredTrial> read_batch(const std::string& name, const std::function<void(const TrialRecord& record)>& use) {
  check_readable(FileKind::batch, name);
  const DatasetReader reader = DatasetReader::of_file(name);
  std::vector<StoredTrial> trials = stored_trials(name);
  for (const StoredTrial& trial : trials) {
    const TrialRecord record = reader.read_trial(trial.number);
    if (reader.stored_digest(trial.number, &record) != trial.digest)
      reject("{}: trial {} does not hold its digest", name, trial.number);
    use(record);
  }
  return trials;
}

}  // namespace

SweepWriter::SweepWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit, std::uint64_t batch_limit)
    : folder_(path), header_(std::move(header)), shard_limit_(shard_limit), batch_limit_(batch_limit) {
  check_dataset_target(path);
}

SweepWriter::~SweepWriter() = default;

std::map<std::size_t, std::string> SweepWriter::resume(const Summarise& summarise) {
  const std::vector<std::string> batches = folder_.batches();
  std::vector<std::string> written = batches;
  if (written.empty() && std::filesystem::exists(folder_.target())) written.push_back(folder_.target());
  for (const std::string& name : written) {
    if (const std::string difference = difference_of(name, header_); !difference.empty())
      refuse_other_run(folder_.target(), name, difference);
  }
  std::map<std::size_t, std::string> summaries;
  for (const std::string& name : batches) {
    try {
      std::map<std::size_t, std::string> held;
      std::vector<StoredTrial> trials =
          read_batch(name, [&](const TrialRecord& record) { held[record.trial] = summarise(record); });
      std::ranges::move(trials, std::back_inserter(trials_));
      summaries.merge(held);
    } catch (const InputError&) {
      ::unlink(name.c_str());
      damaged_.push_back(name);
    }
  }
  return summaries;
}

void SweepWriter::append(const EncodedTrial& trial) {
  if (batch_ && batch_->bytes() + file_bytes(trial) > batch_limit_) finish_batch();
  if (!batch_) {
    while (std::filesystem::exists(folder_.batch(batch_number_))) ++batch_number_;
    batch_ = std::make_unique<DatasetFile>(temporary_path(folder_.batch(batch_number_)), header_, batch_number_);
  }
  batch_->append(trial);
}

std::optional<std::chrono::steady_clock::time_point> SweepWriter::due() const {
  return batch_ ? std::optional(batch_begin_ + batch_time) : std::nullopt;
}

void SweepWriter::finish_batch() {
  if (!batch_) return;
  const std::unique_ptr<DatasetFile> batch = std::move(batch_);
  batch->finish_batch();
  const std::string name = folder_.batch(batch_number_);
  rename_file(batch->path(), name);
  sync_folder_of(name);
  for (StoredTrial trial : batch->trials()) {
    trial.file = name;
    trials_.push_back(std::move(trial));
  }
  batch_begin_ = std::chrono::steady_clock::now();
}

std::vector<std::string> SweepWriter::commit() {
  DatasetWriter writer(folder_, header_, shard_limit_);
  if (trials_.empty() && batch_ && batch_->bytes() <= shard_limit_) {
    writer.adopt(std::move(batch_));
  } else {
    finish_batch();
    std::ranges::sort(trials_, {}, &StoredTrial::number);
    copy_trials(trials_, writer);
  }
  for (const FailedTrial& failed : failed_) writer.add_failed(failed);
  std::vector<std::string> files = writer.commit();
  folder_.remove_batches();
  folder_.close();
  return files;
}

std::vector<std::string> SweepWriter::keep() {
  finish_batch();
  return folder_.batches();
}

}  // namespace slipbench
