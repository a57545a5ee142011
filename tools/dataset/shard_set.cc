#include "tools/dataset/shard_set.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "sim/core/process/check_readable.h"
#include "tools/dataset/dataset_file.h"
#include "tools/dataset/hdf5/hdf5_place.h"
#include "tools/dataset/stored_trials.h"
#include "tools/dataset/trial_difference.h"
#include "tools/dataset/writer.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

std::string normal(const std::string& path) { return std::filesystem::path(path).lexically_normal().string(); }

// "trial 3 is missing", "trials 3, 4 and 5 more are missing".
std::string missing_text(const char* what, const std::vector<std::size_t>& numbers, const std::string& total_text) {
  constexpr std::size_t most = 8;
  std::string text = fmt::format(
      "{}{} {}", what, numbers.size() == 1 ? "" : "s",
      fmt::join(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(std::min(most, numbers.size())), ", "));
  if (numbers.size() > most) text += fmt::format(" and {} more", numbers.size() - most);
  return text + total_text + (numbers.size() == 1 ? " is missing" : " are missing");
}

void refuse_input_as_output(const std::vector<std::string>& inputs, const std::string& output) {
  std::error_code error;
  for (const std::string& input : inputs) {
    if (std::filesystem::equivalent(input, output, error)) {
      reject("cannot write {}: it is one of the shards; choose another name", output);
    }
  }
}

TrialRecord record_of(const StoredTrial& stored) { return DatasetReader::of_file(stored.file).read_trial(stored.number); }

// Reads the scene's split, which the shard's masks do not contain.
std::optional<SplitRule> split_of(const std::string& path) {
  const hdf5::Handle file = hdf5::open_file(path);
  const hdf5::Place mask{file.get(), path, "/mask"};
  const hdf5::Handle object = hdf5::open_object(mask);
  if (H5Aexists(object.get(), split_shares_name) <= 0) return std::nullopt;
  const hdf5::Attribute attribute = hdf5::open_attribute(mask, object, split_shares_name);
  SplitRule rule{hdf5::text_of(mask, object, "split_by"), {}};
  if (attribute.shape != std::vector{rule.shares.size()} || H5Tget_class(attribute.type.get()) != H5T_FLOAT ||
      H5Aread(attribute.handle.get(), H5T_NATIVE_DOUBLE, rule.shares.data()) < 0) {
    mask.fail("attribute 'shares' is not three numbers");
  }
  return rule;
}

}  // namespace

ShardSet::ShardSet(const std::vector<std::string>& paths) {
  std::set<std::string> later;
  for (const std::string& path : paths) {
    check_readable(FileKind::dataset_file, path);
    std::optional<FileAbout> about = file_about(path);
    if (!about) throw InputError(path + ": is not a dataset");
    if (!about->header.part) throw InputError(path + ": is not a shard of a sweep; expected files written by sweep --shard k/n");
    if (about->shard > 0) {
      later.insert(normal(path));
    } else {
      add_shard(path, std::move(*about));
    }
  }
  for (const std::string& name : files()) later.erase(normal(name));
  if (!later.empty()) throw InputError(*later.begin() + ": is a later file of a shard; give the shard's first file");
  for (const Shard& shard : shards_) {
    check_same_sweep(shard);
    for (const FailedTrial& trial : shard.about.failed) failed_.emplace(trial.trial, trial);
  }
  for (const Shard& shard : shards_) add_trials(shard);
}

void ShardSet::add_shard(const std::string& path, FileAbout about) {
  if (!about.complete) {
    throw InputError(path + ": its run did not finish; complete the shard by its command with --resume");
  }
  about.header.split = split_of(path);
  Shard shard{path, std::move(about), {}};
  for (std::size_t k = 0; k < *shard.about.shards; ++k) shard.files.push_back(shard_path(path, k));
  shards_.push_back(std::move(shard));
}

void ShardSet::check_same_sweep(const Shard& shard) const {
  const Shard& first = shards_.front();
  const DatasetHeader& one = shard.about.header;
  const auto refuse = [&](const std::string& difference) {
    reject("{}: is not a shard of the same sweep as {}: it has {}", shard.path, first.path, difference);
  };
  const std::string difference = header_difference(whole_header(one), whole_header(header()), first.path);
  if (!difference.empty()) refuse(difference);
  if (one.part->count != header().part->count)
    refuse(fmt::format("shard {}, but {} has shard {}", shard_text(*one.part), first.path, shard_text(*header().part)));
  if (one.part->trials != header().part->trials)
    refuse(fmt::format("{} in total, but {} has {}", counted(one.part->trials, "trial"), first.path, header().part->trials));
}

void ShardSet::add_trials(const Shard& shard) {
  const std::size_t all = header().part->trials;
  for (const std::string& file : shard.files) {
    for (StoredTrial& trial : stored_trials(file)) {
      if (trial.number >= all)
        reject("{}: contains trial {}; allowed: 0 to {}, the trials of its sweep", file, trial.number, all - 1);
      if (failed_.contains(trial.number)) reject("{}: contains trial {}, which has failed in another shard", file, trial.number);
      const auto [same, added] = trials_.try_emplace(trial.number, trial);
      if (added) continue;
      ++duplicates_;
      if (same->second.digest == trial.digest) continue;
      const std::string difference = trial_difference(record_of(trial), record_of(same->second));
      if (!difference.empty()) {
        reject("{}: trial {} differs from the same trial in {}: {}; leave one of the two files out", file, trial.number,
               same->second.file, difference);
      }
      ++within_rounding_;
    }
  }
}

std::vector<std::string> ShardSet::gaps() const {
  const SweepShard& part = *header().part;
  std::set<std::size_t> there;
  for (const Shard& shard : shards_) there.insert(shard.about.header.part->number);
  std::vector<std::size_t> missing;
  for (std::size_t number = 1; number <= part.count; ++number) {
    if (!there.contains(number)) missing.push_back(number);
  }
  if (!missing.empty()) return {missing_text("shard", missing, fmt::format(" of {}", part.count))};
  for (std::size_t trial = 0; trial < part.trials; ++trial) {
    if (!trials_.contains(trial) && !failed_.contains(trial)) missing.push_back(trial);
  }
  if (!missing.empty()) return {missing_text("trial", missing, "")};
  return {};
}

std::vector<std::string> ShardSet::paths() const {
  std::vector<std::string> names;
  for (const Shard& shard : shards_) names.push_back(shard.path);
  return names;
}

std::vector<std::string> ShardSet::files() const {
  std::vector<std::string> names;
  for (const Shard& shard : shards_) names.insert(names.end(), shard.files.begin(), shard.files.end());
  return names;
}

std::vector<StoredTrial> ShardSet::trials() const {
  std::vector<StoredTrial> trials;
  for (const auto& [number, trial] : trials_) trials.push_back(trial);
  return trials;
}

std::vector<FailedTrial> ShardSet::failed() const {
  std::vector<FailedTrial> failed;
  for (const auto& [number, trial] : failed_) failed.push_back(trial);
  return failed;
}

Merged merge_shards(const std::vector<std::string>& paths, const std::string& output, const std::atomic<bool>* interrupt) {
  const ShardSet set(paths);
  refuse_input_as_output(set.files(), output);
  if (const std::vector<std::string> gaps = set.gaps(); !gaps.empty()) {
    reject("cannot write {}: {}; give all shards of the sweep", output, fmt::join(gaps, "; "));
  }
  if (set.size() == 0) reject("cannot write {}: all trials of the sweep have failed", output);
  // Chunks are copied compressed, so this check is the only one that detects disk damage.
  for (const std::string& shard : set.paths()) check_readable(FileKind::dataset, shard);
  DatasetWriter writer(output, whole_header(set.header()));
  copy_trials(set.trials(), writer, interrupt);
  for (const FailedTrial& failed : set.failed()) writer.add_failed(failed);
  return {set.size(), set.failed().size(), set.duplicates(), set.within_rounding(), writer.commit()};
}

Json merged_json(const Merged& merged) {
  return {{"files", merged.files},
          {"trials", merged.trials},
          {"failed", merged.failed},
          {"duplicates", merged.duplicates},
          {"within_rounding", merged.within_rounding}};
}

}  // namespace slipbench
