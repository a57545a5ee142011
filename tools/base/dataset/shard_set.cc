#include "tools/base/dataset/shard_set.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/process/check_readable.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/stored_trials.h"
#include "tools/base/dataset/trial_difference.h"
#include "tools/base/dataset/writer.h"
#include "tools/base/files/reject.h"

namespace slipbench {
namespace {

std::string normal(const std::string& path) { return std::filesystem::path(path).lexically_normal().string(); }

// "trial 3 is missing", "trials 3, 4 and 5 more are missing".
std::string missing_text(const char* what, const std::vector<std::size_t>& numbers, const std::string& of) {
  constexpr std::size_t most = 8;
  std::string text = fmt::format(
      "{}{} {}", what, numbers.size() == 1 ? "" : "s",
      fmt::join(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(std::min(most, numbers.size())), ", "));
  if (numbers.size() > most) text += fmt::format(" and {} more", numbers.size() - most);
  return text + of + (numbers.size() == 1 ? " is missing" : " are missing");
}

void refuse_input_as_output(const std::vector<std::string>& inputs, const std::string& output) {
  std::error_code error;
  for (const std::string& input : inputs) {
    if (std::filesystem::equivalent(input, output, error)) {
      reject("cannot write {}: it is one of the shards; allowed: a new name, or a dataset to replace", output);
    }
  }
}

}  // namespace

ShardSet::ShardSet(const std::vector<std::string>& paths) {
  std::set<std::string> later;
  for (const std::string& path : paths) {
    check_readable(FileKind::dataset_file, path);
    std::optional<FileAbout> about = file_about(path);
    if (about && about->header.part && about->shard > 0) {
      later.insert(normal(path));
    } else {
      shards_.push_back(std::make_unique<StoredTrials>(path, std::move(about)));
    }
  }
  for (const auto& shard : shards_) check_readable(FileKind::dataset_header, shard->path());
  for (const std::string& name : files()) later.erase(normal(name));
  if (!later.empty()) throw InputError(*later.begin() + ": is a further file of a shard; allowed: with the shard's first file");

  for (const auto& shard : shards_) {
    const DatasetHeader& one = shard->about().header;
    const auto refuse = [&](const std::string& difference) {
      reject("{}: is no shard of the same sweep as {}: it has {}", shard->path(), shards_.front()->path(), difference);
    };
    const std::string other = shards_.front()->path();
    const std::string difference = header_difference(whole_header(one), whole_header(header()), other);
    if (!difference.empty()) refuse(difference);
    if (one.part->count != header().part->count)
      refuse(fmt::format("shard {}, {} has {}", shard_text(*one.part), other, shard_text(*header().part)));
    if (one.part->trials != header().part->trials)
      refuse(fmt::format("{} trials in all, {} has {}", one.part->trials, other, header().part->trials));
    for (const FailedTrial& trial : shard->about().failed) failed_.emplace(trial.trial, trial);
  }
  look_for_gaps();
}

void ShardSet::look_for_gaps() {
  const SweepShard& part = *header().part;
  std::vector<bool> there(part.trials, false);
  std::vector<bool> shard_there(part.count + 1, false);
  for (const auto& shard : shards_) {
    shard_there[shard->about().header.part->number] = true;
    for (const auto& [trial, group] : shard->list()) {
      if (trial >= part.trials) {
        reject("{}: holds trial {}; allowed: 0 to {}, those of its sweep", shard->path(), trial, part.trials - 1);
      }
      if (failed_.contains(trial)) reject("{}: holds trial {}, which has failed in a shard", shard->path(), trial);
      if (!there[trial]) ++count_;
      there[trial] = true;
    }
  }
  for (const auto& [trial, failed] : failed_) {
    if (trial < part.trials) there[trial] = true;
  }
  std::vector<std::size_t> missing;
  for (std::size_t number = 1; number <= part.count; ++number) {
    if (!shard_there[number]) missing.push_back(number);
  }
  if (!missing.empty()) {
    gaps_.push_back(missing_text("shard", missing, fmt::format(" of {}", part.count)));
    return;
  }
  for (std::size_t trial = 0; trial < part.trials; ++trial) {
    if (!there[trial]) missing.push_back(trial);
  }
  if (!missing.empty()) gaps_.push_back(missing_text("trial", missing, ""));
}

ShardSet::~ShardSet() = default;

std::vector<std::pair<std::size_t, std::string>> ShardSet::list() {
  std::vector<std::pair<std::size_t, std::string>> all;
  for (const auto& shard : shards_) std::ranges::move(shard->list(), std::back_inserter(all));
  std::ranges::sort(all);
  return all;
}

const DatasetHeader& ShardSet::header() const { return shards_.front()->about().header; }

std::vector<std::string> ShardSet::paths() const {
  std::vector<std::string> paths;
  for (const auto& shard : shards_) paths.push_back(shard->path());
  return paths;
}

std::vector<std::string> ShardSet::files() const {
  std::vector<std::string> names;
  for (const auto& shard : shards_) std::ranges::move(shard->files(), std::back_inserter(names));
  return names;
}

std::vector<FailedTrial> ShardSet::failed() const {
  std::vector<FailedTrial> all;
  for (const auto& [number, failed] : failed_) all.push_back(failed);
  return all;
}

std::vector<StoredTrials*> ShardSet::at_least() {
  std::vector<StoredTrials*> least;
  for (const auto& shard : shards_) {
    if (!shard->trial()) continue;
    if (!least.empty() && *shard->trial() < *least.front()->trial()) least.clear();
    if (least.empty() || *shard->trial() == *least.front()->trial()) least.push_back(shard.get());
  }
  for (std::size_t i = 1; i < least.size(); ++i) {
    if (least[i]->sha256() == least.front()->sha256()) continue;
    const std::string difference = trial_difference(least[i]->read(), least.front()->read());
    if (!difference.empty()) {
      reject("{}: trial {} is not that of {}: {}; allowed: one of the two files", least[i]->path(), *least[i]->trial(),
             least.front()->path(), difference);
    }
    ++within_rounding_;
  }
  return least;
}

std::optional<EncodedTrial> ShardSet::next(std::size_t& duplicates) {
  const std::vector<StoredTrials*> least = at_least();
  if (least.empty()) return std::nullopt;
  duplicates += least.size() - 1;
  EncodedTrial trial = least.front()->read();
  for (StoredTrials* shard : least) shard->advance();
  return trial;
}

std::size_t ShardSet::check_duplicates() {
  std::size_t duplicates = 0;
  for (std::vector<StoredTrials*> least = at_least(); !least.empty(); least = at_least()) {
    duplicates += least.size() - 1;
    for (StoredTrials* shard : least) shard->advance();
  }
  return duplicates;
}

Merged merge_shards(const std::vector<std::string>& paths, const std::string& output) {
  ShardSet set(paths);
  refuse_input_as_output(set.files(), output);
  if (const std::vector<std::string> gaps = set.gaps(); !gaps.empty()) {
    reject("cannot write {}: {}; allowed: all shards of a sweep", output, fmt::join(gaps, "; "));
  }
  if (set.size() == 0) reject("cannot write {}: all trials of the sweep have failed", output);
  ShardSet(paths).check_duplicates();
  // Chunks are copied as they are: what a disk has changed in them would be told by nobody.
  for (const std::string& shard : set.paths()) check_readable(FileKind::dataset, shard);

  Merged merged;
  const DatasetHeader header = whole_header(set.header());
  std::optional<KeptTrials> kept;  // of a merge that was killed
  if (!leftovers(output).empty()) kept.emplace(output, header);
  DatasetWriter writer(output, header, set.header().part->trials, DatasetWriter::default_shard_limit, kept ? &*kept : nullptr);
  try {
    while (const std::optional<EncodedTrial> trial = set.next(merged.duplicates)) writer.append(*trial);
    for (const FailedTrial& failed : set.failed()) writer.add_failed(failed);
    merged.trials = writer.size();
    merged.failed = set.failed().size();
    merged.within_rounding = set.within_rounding();
    merged.files = writer.commit();
  } catch (...) {
    if (!kept) writer.discard();
    throw;
  }
  return merged;
}

}  // namespace slipbench
