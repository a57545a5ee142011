#include "tools/dataset/header.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/counted.h"
#include "sim/core/random.h"
#include "tools/dataset/record/json.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

constexpr std::array<double, 3> usual_shares{0.70, 0.15, 0.15};

// `share` of `count` groups, rounded to the nearest; at least one if the share is above 0.
std::size_t part_of(std::size_t count, double share) {
  if (share == 0.0) return 0;
  constexpr double rounding = 1e-9;  // halves round up although 0.15 is inexact as a double
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::floor(share * static_cast<double>(count) + 0.5 + rounding)));
}

constexpr char experiment_mark = '\x1f';  // unit separator, before each key of the experiment

// Trials (number, split_group_text()) by experiment: those that share a key, directly or by other
// trials. In the order of their first trials.
std::vector<std::vector<std::size_t>> experiments_in(const std::vector<std::pair<std::size_t, std::string>>& trials) {
  std::vector<std::size_t> first(trials.size());  // index of an earlier trial of the same experiment, or its own
  const auto root = [&first](std::size_t i) {
    while (first[i] != i) i = first[i] = first[first[i]];
    return i;
  };
  std::map<std::string_view, std::size_t> trial_with;  // by key: the first trial that has it
  for (std::size_t i = 0; i < trials.size(); ++i) {
    first[i] = i;
    std::string_view rest = trials[i].second;
    rest.remove_prefix(std::min(rest.find(experiment_mark), rest.size()));
    while (!rest.empty()) {
      rest.remove_prefix(1);
      const std::string_view key = rest.substr(0, rest.find(experiment_mark));
      rest.remove_prefix(key.size());
      const std::size_t one = root(trial_with.emplace(key, i).first->second), other = root(i);
      first[std::max(one, other)] = std::min(one, other);
    }
  }
  std::vector<std::vector<std::size_t>> experiments;
  std::map<std::size_t, std::size_t> experiment_with_root;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const auto [known, is_new] = experiment_with_root.emplace(root(i), experiments.size());
    if (is_new) experiments.emplace_back();
    experiments[known->second].push_back(trials[i].first);
  }
  return experiments;
}

std::string rule_text(const std::optional<SplitRule>& rule, bool one_material, bool repeats) {
  const std::string together = repeats ? "; repeats of one experiment are in one part" : "";
  if (!rule) {
    return one_material ? "70/15/15 % of the trials, shuffled by the seed, since all share one material" + together
                        : "70/15/15 % of the materials, shuffled by the seed; no material is in two parts";
  }
  const auto& [train, valid, test] = rule->shares;
  const std::string shares = fmt::format("{:.4g}/{:.4g}/{:.4g} % of the", 100.0 * train, 100.0 * valid, 100.0 * test);
  if (rule->by == "trial") return fmt::format("{} trials, shuffled by the seed, {}{}", shares, rule->said_by, together);
  return fmt::format("{} {}s, shuffled by the seed, {}; no {} is in two parts", shares, rule->by, rule->said_by, rule->by);
}

// Returns the first line in which two texts differ.
std::string line_difference(const std::string& left, const std::string& now, const std::string& other) {
  std::istringstream left_lines(left);
  std::istringstream now_lines(now);
  std::string left_line;
  std::string now_line;
  for (std::size_t number = 1;; ++number) {
    const bool left_has = static_cast<bool>(std::getline(left_lines, left_line));
    const bool now_has = static_cast<bool>(std::getline(now_lines, now_line));
    if (!left_has) return fmt::format("scene that ends at line {}, where the scene of {} has '{}'", number, other, now_line);
    if (!now_has) return fmt::format("scene with '{}' in line {}, where the scene of {} ends", left_line, number, other);
    if (left_line != now_line) {
      return fmt::format("scene with '{}' in line {}, where the scene of {} has '{}'", left_line, number, other, now_line);
    }
  }
}

// Returns, as a clause, the first file that only one run names or whose digest differs.
std::string file_difference(const std::map<std::string, std::string>& left, const std::map<std::string, std::string>& now,
                            const std::string& other) {
  for (const auto& [path, digest] : left) {
    if (!now.contains(path)) return fmt::format("file {}, which the scene of {} does not use", path, other);
    if (now.at(path) != digest) return fmt::format("file {} has changed since then", path);
  }
  for (const auto& [path, digest] : now) {
    if (!left.contains(path)) return fmt::format("no file {}, which the scene of {} uses", path, other);
  }
  return "";
}

}  // namespace

std::string failures_json(const std::vector<FailedTrial>& failed) {
  Json list = Json::array();
  for (const FailedTrial& one : failed)
    list.push_back({{"trial", one.trial}, {"message", one.message}, {"command", one.command}});
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<FailedTrial> parse_failures(const std::string& file_name, const std::string& text) {
  std::vector<FailedTrial> failed;
  try {
    for (const auto& one : nlohmann::json::parse(text)) failed.push_back({one.at("trial"), one.at("message"), one.at("command")});
  } catch (const nlohmann::json::exception&) {
    throw InputError(file_name + ": /: attribute 'failed' is not a list of failed trials");
  }
  return failed;
}

std::string files_json(const std::map<std::string, std::string>& files) {
  return nlohmann::json(files).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::map<std::string, std::string> parse_files(const std::string& file_name, const std::string& text) {
  try {
    return nlohmann::json::parse(text).get<std::map<std::string, std::string>>();
  } catch (const nlohmann::json::exception&) {
    throw InputError(file_name + ": /: attribute 'files' is not a list of files and their SHA-256");
  }
}

std::string shard_words(const SweepShard& shard) { return " --shard " + shard_text(shard); }

std::string shard_text(const SweepShard& shard) { return fmt::format("{}/{}", shard.number, shard.count); }

SweepShard parse_shard(const std::string& file_name, const std::string& text, std::uint64_t trials) {
  SweepShard shard{.number = 0, .count = 0, .trials = trials};
  const char* const end = text.data() + text.size();
  const auto [slash, number_error] = std::from_chars(text.data(), end, shard.number);
  const bool has_count = number_error == std::errc() && slash != end && *slash == '/';
  if (has_count) std::from_chars(slash + 1, end, shard.count);
  if (shard_text(shard) != text || shard.number < 1 || shard.number > shard.count || shard.count > trials) {
    reject("{}: /: attribute 'sweep_shard' is {}, which is not a shard of {}", file_name, quote(text), counted(trials, "trial"));
  }
  return shard;
}

DatasetHeader whole_header(const DatasetHeader& shard) {
  DatasetHeader whole = shard;
  if (!shard.part) return whole;
  const std::string words = shard_words(*shard.part);
  if (whole.command.ends_with(words)) whole.command.resize(whole.command.size() - words.size());
  whole.part.reset();
  return whole;
}

std::string failures_text(const std::vector<FailedTrial>& failed, std::size_t planned) {
  if (failed.empty()) return "";
  constexpr std::size_t most = 10;
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < std::min(failed.size(), most); ++i) numbers.push_back(std::to_string(failed[i].trial));
  std::string list = numbers.front();
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    list += (i + 1 == numbers.size() && failed.size() <= most ? " and " : ", ") + numbers[i];
  }
  if (failed.size() > most) list += fmt::format(" and {} more", failed.size() - most);
  return fmt::format("{} of {} failed: {}", failed.size(), counted(planned, "trial"), list);
}

std::string shard_path(const std::string& path, std::size_t shard) {
  if (shard == 0) return path;
  const std::filesystem::path whole(path);
  std::filesystem::path name = whole.stem();
  name += fmt::format("-{:04}", shard);
  name += whole.extension();
  return (whole.parent_path() / name).string();
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

std::string split_group_text(const std::string& name, const std::vector<std::string>& keys) {
  std::string text = name;
  for (const std::string& key : keys) {
    if (!key.empty()) text += experiment_mark + key;
  }
  return text;
}

Masks split_trials(const std::vector<std::pair<std::size_t, std::string>>& trials, std::uint64_t seed,
                   const std::optional<SplitRule>& rule) {
  std::map<std::string, std::vector<std::size_t>> by_name;
  for (const auto& [trial, group] : trials) by_name[group.substr(0, group.find(experiment_mark))].push_back(trial);
  std::vector<std::vector<std::size_t>> experiments = experiments_in(trials);
  const bool one_material = by_name.size() <= 1;

  Masks masks;
  masks.split_by = rule ? rule->by : one_material ? "trial" : "material";
  masks.rule = rule_text(rule, one_material, experiments.size() < trials.size());
  std::vector<std::vector<std::size_t>> groups;
  if (masks.split_by == "trial") {
    groups = std::move(experiments);
  } else {
    for (auto& [name, members] : by_name) groups.push_back(std::move(members));
  }

  masks.groups = groups.size();
  RandomStream random(seed, 0, "mask");
  shuffle(groups, random);
  const std::array<double, 3>& shares = rule ? rule->shares : usual_shares;
  const std::size_t spare = groups.empty() ? 0 : groups.size() - 1;  // one stays for training
  const std::size_t test = std::min(spare, part_of(groups.size(), shares[2]));
  const std::size_t valid = std::min(spare - test, part_of(groups.size(), shares[1]));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    std::vector<std::size_t>& part = i < test ? masks.test : i < test + valid ? masks.valid : masks.train;
    part.insert(part.end(), groups[i].begin(), groups[i].end());
  }
  for (auto* part : {&masks.train, &masks.valid, &masks.test}) std::sort(part->begin(), part->end());
  return masks;
}

}  // namespace slipbench
