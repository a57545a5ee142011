#include "tools/base/dataset/writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <span>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/process/check_readable.h"
#include "sim/core/process/regular_file.h"
#include "tools/base/dataset/checked_dataset.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/shard.h"
#include "tools/base/files/reject.h"

namespace slipbench {
namespace {

// Room for what a file gets when it is finished: masks and closing attributes [bytes].
std::uint64_t closing_bytes(std::size_t trials) { return 32768 + 32 * static_cast<std::uint64_t>(trials); }

// Makes names in the folder of `path` last.
void sync_folder(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Descriptor descriptor(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (descriptor.get() < 0 || !sync_file(descriptor.get(), true)) {
    reject("a power failure may take the name of {}: its folder cannot be synced: {}", path, std::strerror(errno));
  }
}

// Where two texts of several lines part.
std::string line_difference(const std::string& left, const std::string& now, const std::string& other) {
  std::istringstream left_lines(left);
  std::istringstream now_lines(now);
  std::string left_line;
  std::string now_line;
  for (std::size_t number = 1;; ++number) {
    const bool left_has = static_cast<bool>(std::getline(left_lines, left_line));
    const bool now_has = static_cast<bool>(std::getline(now_lines, now_line));
    if (!left_has) left_line = "(its end)";
    if (!now_has) now_line = "(its end)";
    if (left_line != now_line || !left_has || !now_has) {
      return fmt::format("scene with line {} '{}', {}'s has '{}'", number, left_line, other, now_line);
    }
  }
}

// The first file that two runs have named and found different, as a clause.
std::string file_difference(const std::map<std::string, std::string>& left, const std::map<std::string, std::string>& now,
                            const std::string& other) {
  for (const auto& [path, digest] : left) {
    if (!now.contains(path)) return fmt::format("file {}, which {}'s scene does not name", path, other);
    if (now.at(path) != digest) return fmt::format("file {} has changed since", path);
  }
  for (const auto& [path, digest] : now) {
    if (!left.contains(path)) return fmt::format("no file {}, which {}'s scene names", path, other);
  }
  return "";
}

// The values of the arrays of codes that are counted, by their paths.
using Codes = std::map<std::string, std::vector<std::uint8_t>>;

// What is told of a trial: outcome, samples in each state, the loop's counts. Throws std::out_of_range where something is missing or is no state.
TrialRecord counts_of(const EncodedTrial& trial, const Codes& codes) {
  std::map<std::string, EncodedAttribute> attributes;
  for (const EncodedAttribute& attribute : trial.attributes) attributes.emplace(attribute.path + "@" + attribute.name, attribute);
  const auto text = [&](const std::string& key) { return std::get<std::string>(attributes.at(key).value); };
  TrialRecord record;
  record.trial = trial.trial;
  record.params = text("@params");
  record.outcome = parse_outcome(text("@outcome"));
  std::map<std::string, std::vector<std::uint8_t>> states;  // by sensor
  for (const EncodedArray& array : trial.arrays) {
    const std::string name = array.path.substr(0, array.path.rfind('/'));
    if (array.path != name + "/state") continue;
    SensorRecord& sensor = record.sensors.emplace_back();
    sensor.name = name.substr(name.find('/') + 1);
    states[sensor.name] = codes.at(array.path);
    for (const std::uint8_t state : codes.at(array.path)) ++sensor.labels.state_count.at(state);
    for (const std::uint8_t state : codes.at(name + "/state_micro")) ++sensor.labels.state_micro_count.at(state);
  }
  const std::string control = std::string(control_group) + "@";
  if (!attributes.contains(control + "detector")) return record;
  ControlRecord& loop = record.control.emplace();
  loop.detector = text(control + "detector");
  loop.controller = text(control + "controller");
  loop.sensor = text(control + "sensor");
  if (record.sensors.empty()) {
    const auto& counts = std::get<EncodedAttribute::Doubles>(attributes.at(control + "confusion").value).values;
    for (std::size_t i = 0; i < counts.size(); ++i)
      loop.confusion.at(i / loop.confusion.size())[i % loop.confusion.size()] = static_cast<std::size_t>(counts[i]);
    return record;
  }
  const std::vector<std::uint8_t>& said = codes.at(std::string(control_group) + "/detector_class");
  for (std::size_t row = 0; row < said.size(); ++row) ++loop.confusion.at(states.at(loop.sensor).at(row)).at(said[row]);
  return record;
}

}  // namespace

struct DatasetWriter::State {
  std::string path;
  DatasetHeader header;
  std::size_t planned = 0;
  std::uint64_t shard_limit = 0;
  std::vector<Shard> shards;
  std::vector<std::pair<std::size_t, std::string>> trials;  // number, material
  std::vector<FailedTrial> failed;
  std::vector<std::string> kept_files;  // of the run that this one goes on with
  std::size_t kept = 0;                 // trials in them
  std::size_t kept_instead = 0;         // of these, those that keep_partial() has left in place of fewer of this run
  std::size_t longest_group = 0;        // bytes, of a trial's material
  std::size_t checked = 0;              // files whose names were looked at before the run began
  bool ended = false;

  void add_shard() {
    if (!shards.empty()) shards.back().park();
    if (shards.size() >= checked) check_names_are_free(path, shards.size());
    const std::size_t left = planned > trials.size() ? planned - trials.size() : 0;
    const std::size_t numbers = header.part ? header.part->trials : planned;
    const std::size_t last = std::max<std::size_t>(numbers, 10'000) - 1;
    shards.emplace_back(temporary_path(shard_path(path, shards.size())), header, shards.size(), left, last);
    sync_folder(shards.back().path());
  }

  // Leaves of a run that did not come to its end what is safe.
  void drop_unpublished() {
    try {
      if (!shards.back().failed()) shards.back().publish();
    } catch (const InputError&) {
      // A full disk; what was published before stays.
    }
    trials.resize(published());
    while (!shards.empty() && shards.back().published() == 0) {
      ::unlink(shards.back().path().c_str());
      shards.pop_back();
    }
  }

  [[nodiscard]] std::size_t published() const {
    std::size_t count = 0;
    for (const Shard& shard : shards) count += shard.published();
    return count;
  }

  // Finishes every file and gives it its name under `target`, the first file last: once it is there, all are.
  std::vector<std::string> finish_as(const std::string& target, bool complete) {
    const Masks masks = split_trials(trials, header.seed, header.split);
    // The first file last: where it is complete, all are.
    for (std::size_t k = shards.size(); k-- > 0;) {
      Shard& shard = shards[k];
      if (shard.failed() || shard.prepared()) continue;  // its trials stay as they are, without a mask
      try {
        shard.prepare(masks, failed, shards.size(), complete);
        shard.close();
      } catch (const InputError&) {
        if (complete) throw;
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
    ended = true;
    for (const std::string& name : stale) ::unlink(name.c_str());
    remove_temporary(path, count);
    remove_kept(path, complete ? 0 : count);
    sync_folder(target);
    return names;
  }
};

DatasetWriter::DatasetWriter(std::string path, DatasetHeader header, std::size_t planned, std::uint64_t shard_limit,
                             const KeptTrials* kept)
    : state_(std::make_unique<State>()) {
  const std::size_t files = std::max<std::size_t>(1, (planned + most_trials_per_file - 1) / most_trials_per_file);
  state_->checked = check_dataset_targets(path, files, kept != nullptr);
  if (kept != nullptr) {
    state_->kept = kept->size();
    state_->kept_files = kept->files();
  }
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
  state_->longest_group = std::max(state_->longest_group, trial.material.size());
  const std::uint64_t groups = state_->header.part ? (held + 1) * state_->longest_group : 0;
  const bool too_large = last.size_bytes() + needed + closing_bytes(held + 1) + groups > state_->shard_limit;
  if (held == most_trials_per_file || (held > 0 && too_large)) state_->add_shard();
  state_->shards.back().append(trial);
  state_->trials.emplace_back(trial.trial, trial.material);
}

void DatasetWriter::add_failed(FailedTrial failed) { state_->failed.push_back(std::move(failed)); }

void DatasetWriter::publish() { state_->shards.back().publish(); }

std::size_t DatasetWriter::size() const { return state_->trials.size() + state_->kept_instead; }

std::size_t DatasetWriter::published() const { return state_->published(); }

std::vector<std::string> DatasetWriter::commit() { return state_->finish_as(state_->path, true); }

std::vector<std::string> DatasetWriter::keep_partial() {
  if (state_->ended) return {};
  state_->ended = true;
  state_->drop_unpublished();
  if (state_->published() < state_->kept) {
    state_->trials.resize(0);
    state_->kept_instead = state_->kept;
    for (const Shard& shard : state_->shards) ::unlink(shard.path().c_str());
    state_->shards.clear();
  }
  if (state_->shards.empty()) return state_->kept_files;
  if (state_->shards.front().prepared()) {
    // It lacks only its name, or is seen to; under this one --resume gives it that.
    std::vector<std::string> names;
    for (const Shard& shard : state_->shards) names.push_back(shard.path());
    state_->shards.clear();
    return names;
  }
  return state_->finish_as(kept_path(state_->path), false);
}

void DatasetWriter::discard() {
  if (state_->ended) return;
  state_->ended = true;
  for (const Shard& shard : state_->shards) ::unlink(shard.path().c_str());
  state_->shards.clear();
}

std::string header_difference(const DatasetHeader& left, const DatasetHeader& now, const std::string& other) {
  std::vector<std::string> parts;
  const auto compare = [&](const char* what, const auto& of_left, const auto& of_now) {
    if (of_left != of_now) parts.push_back(fmt::format("{} {}, {} has {}", what, of_left, other, of_now));
  };
  compare("version", left.version, now.version);
  compare("seed", left.seed, now.seed);
  if (left.scene != now.scene) parts.push_back(line_difference(left.scene, now.scene, other));
  compare("overrides", left.overrides, now.overrides);
  compare("command", left.command, now.command);
  if (const std::string difference = file_difference(left.files, now.files, other); !difference.empty())
    parts.push_back(difference);
  return fmt::format("{}", fmt::join(parts, "; "));
}

std::optional<FinishedDataset> finished_dataset(const std::string& path, const DatasetHeader& header) {
  try {
    const DatasetReader reader = dataset_header_at(path);
    if (!reader.complete() || !header_difference(reader.header(), header).empty()) return std::nullopt;
    return FinishedDataset{reader.trials().size(), reader.failed(), reader.files()};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

KeptTrials::KeptTrials(const std::string& path, const DatasetHeader& header) {
  std::vector<Leftover> found = leftovers(path);
  std::vector<std::string> about;
  for (const Leftover& leftover : found) about.push_back(leftover.name);
  if (about.empty() && std::filesystem::exists(path)) about.push_back(path);
  for (const std::string& name : about) {
    check_readable(FileKind::dataset_file, name);
    const std::optional<FileAbout> found_about = file_about(name);
    const std::string difference = found_about ? header_difference(found_about->header, header) : "it is no dataset";
    if (!difference.empty()) {
      reject(
          "cannot resume {}: {} was written by another run: {}; allowed: the same scene, seed, version, overrides, command and files",
          path, name, difference);
    }
  }
  if (finish_names(path) || gather_leftovers(path) == 0) return;
  const std::string name = kept_path(path);
  found.clear();  // this run writes under the temporary name
  lock_ = lock_file(name);
  reader_.emplace(dataset_header_at(name));
  trials_ = reader_->trials();
  files_ = reader_->files();
}

std::optional<KeptTrials::Trial> KeptTrials::read(std::size_t trial) const {
  try {
    Trial read{{}, reader_->read_encoded(trial)};
    Codes codes;
    const auto see = [&](const EncodedArray& array, std::span<const std::uint8_t> values) {
      if (array.type == ElementType::u8) codes[array.path] = {values.begin(), values.end()};
    };
    if (recomputed_digest(read.encoded, see) != read.encoded.digest) return std::nullopt;
    read.counts = counts_of(read.encoded, codes);
    return read;
  } catch (const std::exception&) {  // is damage, want of memory for a size that it tells among it
  }
  return std::nullopt;
}

bool KeptTrials::holds(std::size_t trial) const { return std::ranges::binary_search(trials_, trial); }

}  // namespace slipbench
