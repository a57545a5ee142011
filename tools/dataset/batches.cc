#include "tools/dataset/batches.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"
#include "sim/core/process/interrupted.h"
#include "tools/dataset/dataset_file.h"
#include "tools/dataset/dataset_target.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/stored_trials.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

[[noreturn]] void refuse_other_run(const std::string& path, const std::string& name, const std::string& difference) {
  reject(
      "cannot resume {}: {} was written by another run: {}; resume with the same scene, seed, version, overrides, command and files",
      path, name, difference);
}

// Returns how the run that wrote `name` differs from this one; empty if it does not. A damaged file
// counts as equal.
std::string difference_of(const std::string& name, const DatasetHeader& header) {
  try {
    check_readable(FileKind::dataset_file, name);
    const std::optional<FileAbout> about = file_about(name);
    return about ? header_difference(about->header, header) : "it is not a dataset";
  } catch (const NotChecked&) {
    throw;
  } catch (const InputError&) {
    return "";
  }
}

// True if a batch is undamaged. Throws InputError if the check itself fails.
bool is_whole(const std::string& name) {
  if (::access(name.c_str(), R_OK) != 0) reject("cannot resume: cannot read {}: {}", name, std::strerror(errno));
  try {
    check_readable(FileKind::batch, name);
    return true;
  } catch (const NotChecked& error) {
    reject("cannot resume: {}", error.what());
  } catch (const InputError&) {
    return false;
  }
}

// Renames a damaged batch, for the user to inspect. Returns its new name.
std::string set_aside(const std::string& name) {
  std::string damaged = name + ".damaged";
  rename_file(name, damaged);
  return damaged;
}

}  // namespace

SweepWriter::SweepWriter(const std::string& path, DatasetHeader header, std::uint64_t shard_limit, std::uint64_t batch_limit)
    : folder_(path), header_(std::move(header)), shard_limit_(shard_limit), batch_limit_(batch_limit) {
  check_dataset_target(path);
}

SweepWriter::~SweepWriter() = default;

std::map<std::size_t, std::string> SweepWriter::resume(const Summarise& summarise) {
  std::vector<std::string> whole, damaged;
  for (const std::string& name : folder_.batches()) {
    end_if_interrupted();
    (is_whole(name) ? whole : damaged).push_back(name);
  }
  std::vector<std::string> written = whole;
  if (written.empty() && std::filesystem::exists(folder_.target())) written.push_back(folder_.target());
  for (const std::string& name : written) {
    if (const std::string difference = difference_of(name, header_); !difference.empty())
      refuse_other_run(folder_.target(), name, difference);
  }
  std::map<std::size_t, std::string> summaries;
  std::map<std::size_t, StoredTrial> held;
  for (const std::string& name : whole) {
    const DatasetReader reader = DatasetReader::of_file(name);
    for (StoredTrial& trial : stored_trials(name)) {
      const auto [twin, is_new] = held.try_emplace(trial.number, trial);
      if (is_new) {
        summaries[trial.number] = summarise(reader.read_trial(trial.number));
        trials_.push_back(std::move(trial));
      } else if (twin->second.digest != trial.digest) {
        reject("cannot resume {}: trial {} is in {} and, with other content, in {}; move one of them away", folder_.target(),
               trial.number, twin->second.file, name);
      }
    }
  }
  for (const std::string& name : damaged) damaged_.push_back(set_aside(name));
  return summaries;
}

void SweepWriter::append(const EncodedTrial& trial) {
  if (batch_ && batch_->bytes() + file_bytes(trial) > batch_limit_) finish_batch();
  if (!batch_) {
    while (std::filesystem::exists(folder_.batch(batch_number_))) ++batch_number_;
    batch_ = std::make_unique<DatasetFile>(temporary_path(folder_.batch(batch_number_)), header_, batch_number_);
  }
  try {
    batch_->append(trial);
  } catch (...) {
    batch_.reset();  // the file was removed and accepts no further trial
    throw;
  }
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
