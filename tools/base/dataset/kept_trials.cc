#include "tools/base/dataset/kept_trials.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/base/dataset/dataset_target.h"
#include "tools/base/dataset/guarded.h"

namespace slipbench {
namespace {

// Where two texts of several lines part.
std::string line_difference(const std::string& left, const std::string& now) {
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
      return fmt::format("scene with line {} '{}', this run's has '{}'", number, left_line, now_line);
    }
  }
}

}  // namespace

std::string header_difference(const DatasetHeader& left, const DatasetHeader& now) {
  std::vector<std::string> parts;
  const auto compare = [&](const char* what, const auto& of_left, const auto& of_now) {
    if (of_left != of_now) parts.push_back(fmt::format("{} {}, this run has {}", what, of_left, of_now));
  };
  compare("version", left.version, now.version);
  compare("seed", left.seed, now.seed);
  if (left.scene != now.scene) parts.push_back(line_difference(left.scene, now.scene));
  compare("overrides", left.overrides, now.overrides);
  compare("command", left.command, now.command);
  return fmt::format("{}", fmt::join(parts, "; "));
}

bool is_complete(const std::string& path, const DatasetHeader& header) {
  try {
    return !guarded(path, [&] {
              const DatasetReader reader(path);
              return std::string(reader.complete() && header_difference(reader.header(), header).empty() ? "yes" : "");
            }).empty();
  } catch (const InputError&) {
    return false;
  }
}

KeptTrials::KeptTrials(const std::string& path, const DatasetHeader& header) {
  for (const std::string& name : leftovers(path)) {
    const std::string difference = guarded(name, [&] { return header_difference(DatasetReader(name).header(), header); });
    if (!difference.empty()) {
      throw InputError(fmt::format(
          "cannot resume {}: {} was left by another run: {}; allowed: the same scene, seed, version, overrides and command", path,
          name, difference));
    }
  }
  if (gather_leftovers(path) > 0) reader_.emplace(kept_path(path));
}

bool KeptTrials::holds(std::size_t trial) const { return reader_ && std::ranges::binary_search(reader_->trials(), trial); }

}  // namespace slipbench
