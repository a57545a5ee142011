#include "tools/base/dataset/writer.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/mask.h"
#include "tools/base/dataset/shard.h"

namespace slipbench {
namespace {

// Room for what a file gets when it is finished: masks and closing attributes [bytes].
std::uint64_t closing_bytes(std::size_t trials) { return 32768 + 32 * static_cast<std::uint64_t>(trials); }

void rename_file(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) {
    throw InputError(fmt::format("cannot rename {} to {}: {}", from, to, std::strerror(errno)));
  }
}

// Makes renamings in the folder of `path` last.
void sync_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Descriptor descriptor(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() < 0 || ::fsync(descriptor.get()) != 0) {
    throw InputError(fmt::format("cannot sync the folder of {}: {}", path, std::strerror(errno)));
  }
}

}  // namespace

struct DatasetWriter::State {
  std::string path;
  DatasetHeader header;
  std::size_t planned = 0;
  std::uint64_t shard_limit = 0;
  std::vector<Shard> shards;
  std::vector<std::pair<std::size_t, std::string>> trials;  // number, material
  std::size_t checked = 0;                                  // files whose names were looked at before the run began
  bool ended = false;

  void add_shard() {
    if (shards.size() >= checked) check_names_are_free(path, shards.size());
    const std::size_t left = planned > trials.size() ? planned - trials.size() : 0;
    shards.emplace_back(temporary_path(shard_path(path, shards.size())), header, shards.size(), left);
  }

  // Finishes every file and gives it its name under `target`, the first file last: once it is there, all are.
  std::vector<std::string> finish_as(const std::string& target, bool complete) {
    const Masks masks = split_trials(trials, header.seed, header.split);
    for (Shard& shard : shards) {
      if (complete) {
        shard.finish(masks, shards.size(), complete);
      } else if (!shard.failed()) {
        try {
          shard.finish(masks, shards.size(), complete);
        } catch (const InputError&) {
          continue;  // the trials are in the file already: a full disk only costs it the masks
        }
      }
    }
    const std::vector<std::string> stale = complete ? later_files(target, shards.size()) : std::vector<std::string>();
    std::vector<std::string> names;
    for (std::size_t k = shards.size(); k-- > 0;) {
      rename_file(shards[k].path(), shard_path(target, k));
      names.insert(names.begin(), shard_path(target, k));
    }
    const std::size_t count = shards.size();
    shards.clear();
    for (const std::string& name : stale) ::unlink(name.c_str());
    remove_temporary(path, count);
    remove_kept(path, complete ? 0 : count);
    sync_folder(target);
    return names;
  }
};

DatasetWriter::DatasetWriter(std::string path, DatasetHeader header, std::size_t planned, std::uint64_t shard_limit)
    : state_(std::make_unique<State>()) {
  const std::size_t files = std::max<std::size_t>(1, (planned + most_trials_per_file - 1) / most_trials_per_file);
  state_->checked = check_dataset_targets(path, files);
  state_->path = std::move(path);
  state_->header = std::move(header);
  state_->planned = planned;
  state_->shard_limit = shard_limit;
  state_->add_shard();
}

DatasetWriter::~DatasetWriter() {
  try {
    keep_partial();
  } catch (const InputError&) {
    return;  // the temporary file keeps what it holds
  }
}

void DatasetWriter::append(const EncodedTrial& trial) {
  if (!state_->trials.empty() && trial.trial <= state_->trials.back().first) {
    throw std::logic_error(fmt::format("trial {} after trial {}", trial.trial, state_->trials.back().first));
  }
  const std::uint64_t needed = trial.stored_bytes() + overhead_bytes(trial);
  const Shard& last = state_->shards.back();
  const std::size_t held = last.trials().size();
  const bool too_large = last.size_bytes() + needed + closing_bytes(held + 1) > state_->shard_limit;
  if (held == most_trials_per_file || (held > 0 && too_large)) state_->add_shard();
  state_->shards.back().append(trial);
  state_->trials.emplace_back(trial.trial, trial.material);
}

std::size_t DatasetWriter::size() const { return state_->trials.size(); }

std::vector<std::string> DatasetWriter::commit() {
  std::vector<std::string> names = state_->finish_as(state_->path, true);
  state_->ended = true;
  return names;
}

std::vector<std::string> DatasetWriter::keep_partial() {
  if (state_->ended) return {};
  state_->ended = true;
  while (!state_->shards.empty() && state_->shards.back().trials().empty()) {
    ::unlink(state_->shards.back().path().c_str());
    state_->shards.pop_back();
  }
  if (state_->shards.empty()) return {};
  return state_->finish_as(kept_path(state_->path), false);
}

}  // namespace slipbench
