#include "tools/base/dataset/header.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/files/output_file.h"

namespace slipbench {

std::string failures_json(const std::vector<FailedTrial>& failed) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const FailedTrial& one : failed)
    list.push_back({{"trial", one.trial}, {"message", one.message}, {"command", one.command}});
  return list.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::vector<FailedTrial> parse_failures(const std::string& file_name, const std::string& text) {
  std::vector<FailedTrial> failed;
  try {
    for (const auto& one : nlohmann::json::parse(text)) failed.push_back({one.at("trial"), one.at("message"), one.at("command")});
  } catch (const nlohmann::json::exception&) {
    throw InputError(file_name + ": /: attribute 'failed' is no list of failed trials");
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
    throw InputError(file_name + ": /: attribute 'files' is no list of files and their SHA-256");
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
    throw InputError(
        fmt::format("{}: /: attribute 'sweep_shard' is {}, which is no shard of {} trials", file_name, quote(text), trials));
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
  return fmt::format("{} of {} trials failed: {}", failed.size(), planned, list);
}

std::string shard_path(const std::string& path, std::size_t shard) {
  if (shard == 0) return path;
  const std::filesystem::path whole(path);
  std::filesystem::path name = whole.stem();
  name += fmt::format("-{:04}", shard);
  name += whole.extension();
  return (whole.parent_path() / name).string();
}

std::string sibling_path(const std::string& path, std::size_t k) {
  constexpr std::string_view mark = ".partial";
  if (!path.ends_with(mark)) return shard_path(path, k);
  return temporary_path(shard_path(path.substr(0, path.size() - mark.size()), k));
}

std::string kept_path(const std::string& path) {
  const std::filesystem::path whole(path);
  std::filesystem::path name = whole.stem();
  name += ".partial";
  name += whole.extension();
  return (whole.parent_path() / name).string();
}

}  // namespace slipbench
