#include "tools/base/dataset/header.h"

#include <filesystem>
#include <string_view>

#include <fmt/format.h>

namespace slipbench {

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

std::string temporary_path(const std::string& path) { return path + ".partial"; }

}  // namespace slipbench
