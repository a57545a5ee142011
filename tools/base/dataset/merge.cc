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

// The work of merge_shards(), in the child process.
Merged merge(const std::vector<std::string>& paths, const std::string& output) {
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
    while (const std::optional<EncodedTrial> trial = set.next(merged.duplicates)) writer.append(*trial);
    for (const FailedTrial& failed : set.failed()) writer.add_failed(failed);
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
    const Merged merged = merge(paths, output);
    return nlohmann::json{merged.trials, merged.failed, merged.duplicates, merged.files}.dump();
  };
  const auto found =
      nlohmann::json::parse(guarded("one of the shards (slipbench verify says which)", reading_limits(paths), action));
  return {found.at(0).get<std::size_t>(), found.at(1).get<std::size_t>(), found.at(2).get<std::size_t>(),
          found.at(3).get<std::vector<std::string>>()};
}

}  // namespace slipbench
