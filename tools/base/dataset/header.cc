#include "tools/base/dataset/header.h"

#include <filesystem>

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

std::string kept_path(const std::string& path) {
  const std::filesystem::path whole(path);
  std::filesystem::path name = whole.stem();
  name += ".partial";
  name += whole.extension();
  return (whole.parent_path() / name).string();
}

std::string temporary_path(const std::string& path) { return path + ".partial"; }

}  // namespace slipbench
