#include "tools/base/dataset/kept_trials.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/files/sha256.h"

namespace slipbench {
namespace {

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

// JSON: the numbers of the trials, and the files' names.
std::string parts_of(const std::string& name) {
  const DatasetReader reader(name);
  return nlohmann::json{reader.trials(), reader.files()}.dump();
}

}  // namespace

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
  const auto look = [&]() -> std::string {
    const DatasetReader reader(path);
    if (!reader.complete() || !header_difference(reader.header(), header).empty()) return "null";
    return nlohmann::json{reader.trials().size(), failures_json(reader.failed()), reader.files()}.dump();
  };
  try {
    const auto found = nlohmann::json::parse(guarded(path, look));
    if (found.is_null()) return std::nullopt;
    return FinishedDataset{found.at(0).get<std::size_t>(), parse_failures(path, found.at(1).get<std::string>()),
                           found.at(2).get<std::vector<std::string>>()};
  } catch (const InputError&) {
    return std::nullopt;
  }
}

KeptTrials::KeptTrials(const std::string& path, const DatasetHeader& header) {
  std::vector<Leftover> found = leftovers(path);
  std::vector<std::string> about;
  for (const Leftover& left : found) about.push_back(left.name);
  if (about.empty() && std::filesystem::exists(path)) about.push_back(path);
  for (const std::string& name : about) {
    const std::string difference = guarded(name, [&] {
      const std::optional<FileAbout> about = file_about(name);
      return about ? header_difference(about->header, header) : "it is no dataset";
    });
    if (!difference.empty()) {
      throw InputError(fmt::format(
          "cannot resume {}: {} was written by another run: {}; allowed: the same scene, seed, version, overrides, command and files",
          path, name, difference));
    }
  }
  if (finish_names(path) || gather_leftovers(path) == 0) return;
  const std::string name = kept_path(path);
  found.clear();  // this run writes under the temporary name
  lock_ = lock_file(name);
  const auto parts = nlohmann::json::parse(guarded(name, [&] { return parts_of(name); }));
  trials_ = parts.at(0).get<std::vector<std::size_t>>();
  files_ = parts.at(1).get<std::vector<std::string>>();
}

std::optional<KeptTrials::Trial> KeptTrials::read(std::size_t trial) const {
  try {
    if (!reader_) reader_.emplace(files_.front());
    Trial read{reader_->read_counts(trial), reader_->read_encoded(trial)};
    if (recomputed_digest(read.encoded) == read.encoded.digest) return read;
  } catch (const std::runtime_error&) {  // is damage
  }
  return std::nullopt;
}

bool KeptTrials::holds(std::size_t trial) const { return std::ranges::binary_search(trials_, trial); }

}  // namespace slipbench
