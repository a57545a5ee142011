#include "tools/base/dataset/merge.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/kept_trials.h"
#include "tools/base/dataset/mask.h"
#include "tools/base/dataset/shard_set.h"
#include "tools/base/dataset/writer.h"

namespace slipbench {
namespace {

void refuse_input_as_output(const std::vector<std::string>& inputs, const std::string& output) {
  std::error_code error;
  for (const std::string& input : inputs) {
    if (std::filesystem::equivalent(input, output, error)) {
      throw InputError(
          fmt::format("cannot write {}: it is one of the shards; allowed: a new name, or a dataset to replace", output));
    }
  }
}

// The masks of the whole, where its files will end by their number of trials and not by their size, and there are more than `few`. Else empty:
// nothing can be foreseen, or nothing is gained.
std::optional<Masks> foreseen_masks(ShardSet& set, const DatasetHeader& whole) {
  constexpr std::size_t few = 2;  // files: the first and the last stay open in any case
  std::uint64_t bytes = 0;
  std::error_code error;
  for (const std::string& file : set.files()) bytes += std::filesystem::file_size(file, error);
  const bool small = bytes / set.size() * most_trials_per_file < DatasetWriter::default_shard_limit / 2;
  if (!small || set.size() <= few * most_trials_per_file) return std::nullopt;
  std::vector<std::pair<std::size_t, std::string>> trials = set.list();
  trials.erase(std::unique(trials.begin(), trials.end()), trials.end());
  return split_trials(trials, whole.seed, whole.split);
}

// The work of merge_shards(), in the child process. `foresees`: whether files are finished before the last trial is there. Empty: that went wrong.
std::optional<Merged> merge(const std::vector<std::string>& paths, const std::string& output, bool foresees) {
  ShardSet set(paths);
  refuse_input_as_output(set.files(), output);
  if (const std::vector<std::string> gaps = set.gaps(); !gaps.empty()) {
    throw InputError(fmt::format("cannot write {}: {}; allowed: all shards of a sweep", output, fmt::join(gaps, "; ")));
  }
  if (set.size() == 0) throw InputError(fmt::format("cannot write {}: all trials of the sweep have failed", output));

  Merged merged;
  const DatasetHeader header = whole_header(set.header());
  std::optional<KeptTrials> kept;  // of a merge that was killed
  if (!leftovers(output).empty()) kept.emplace(output, header);
  DatasetWriter writer(output, header, set.header().part->trials, DatasetWriter::default_shard_limit, kept ? &*kept : nullptr);
  try {
    const std::size_t files = (set.size() + most_trials_per_file - 1) / most_trials_per_file;
    std::optional<Masks> masks = foresees && !kept ? foreseen_masks(set, header) : std::nullopt;
    const bool foreseen = masks.has_value();
    if (masks) writer.foresee(*std::move(masks), set.failed(), files);
    while (const std::optional<EncodedTrial> trial = set.next(merged.duplicates)) writer.append(*trial);
    if (foreseen && writer.files() != files) {
      writer.discard();
      return std::nullopt;
    }
    if (!foreseen) {
      for (const FailedTrial& failed : set.failed()) writer.add_failed(failed);
    }
    merged.trials = writer.size();
    merged.failed = set.failed().size();
    merged.files = writer.commit();
  } catch (...) {
    if (!kept) writer.discard();
    throw;
  }
  return merged;
}

}  // namespace

Merged merge_shards(const std::vector<std::string>& paths, const std::string& output) {
  const auto action = [&] {
    std::signal(SIGXFSZ, SIG_IGN);  // writing beyond a limit is an error like a full disk
    std::optional<Merged> done = merge(paths, output, true);
    if (!done) done = merge(paths, output, false);
    const Merged& merged = *done;
    return nlohmann::json{merged.trials, merged.failed, merged.duplicates, merged.files}.dump();
  };
  const auto found =
      nlohmann::json::parse(guarded("one of the shards (slipbench verify says which)", reading_limits(paths), action));
  return {found.at(0).get<std::size_t>(), found.at(1).get<std::size_t>(), found.at(2).get<std::size_t>(),
          found.at(3).get<std::vector<std::string>>()};
}

}  // namespace slipbench
