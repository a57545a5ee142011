#include "tools/dataset/dataset_target.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/process/check_readable.h"
#include "tools/dataset/header.h"
#include "tools/dataset/reader.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

// Content of a path.
struct Found {
  enum class Kind {
    nothing,
    empty,  // nothing to lose: no bytes, or zeros, as a power failure may leave
    dataset,
    damaged,  // unreadable HDF5
    other,
  };
  Kind kind = Kind::nothing;
  std::uint64_t shard = 0;
  std::uint64_t shards = 0;  // 0: not recorded
  std::string dataset{};     // the same for all files of one dataset
};

using Beginning = std::array<char, 8>;

std::optional<Beginning> beginning_of(const std::string& path) {
  Beginning found{};
  std::ifstream file(path, std::ios::binary);
  if (!file.read(found.data(), found.size())) return std::nullopt;
  return found;
}

Found found_dataset(const std::string& path) {
  check_readable(FileKind::dataset_file, path);
  const std::optional<FileAbout> about = file_about(path);
  if (!about) return {Found::Kind::other};
  const DatasetHeader& header = about->header;
  return {Found::Kind::dataset, about->shard, about->shards.value_or(0),
          fmt::format("{}\n{}\n{}", header.seed, header.command, header.scene)};
}

// Does not follow links.
std::filesystem::file_type type_of(const std::string& path) {
  std::error_code error;
  return std::filesystem::symlink_status(path, error).type();
}

bool stands(const std::string& path) { return type_of(path) != std::filesystem::file_type::not_found; }

Found found_at(const std::string& path) {
  if (!stands(path)) return {Found::Kind::nothing};
  if (type_of(path) != std::filesystem::file_type::regular) return {Found::Kind::other};
  std::error_code error;
  if (std::filesystem::file_size(path, error) == 0) return {Found::Kind::empty};
  constexpr Beginning hdf5{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  const std::optional<Beginning> beginning = beginning_of(path);
  if (beginning == Beginning{}) return {Found::Kind::empty};
  if (beginning != hdf5) return {Found::Kind::other};
  try {
    return found_dataset(path);
  } catch (const NotChecked&) {
    throw;
  } catch (const InputError&) {
    return {Found::Kind::damaged};
  }
}

}  // namespace

void check_dataset_target(const std::string& path, std::size_t k) {
  const std::string name = shard_path(path, k);
  check_target(name);
  const Found found = found_at(name);
  if (found.kind == Found::Kind::nothing || found.kind == Found::Kind::empty) return;
  const std::string subject = k == 0 ? "it" : fmt::format("{}, file {} of the dataset,", name, k);
  const auto refuse = [&](const std::string& what) {
    reject("cannot write {}: {} exists and is {}; choose a new name, or a dataset to replace", path, subject, what);
  };
  // The user named the first file, so it may be replaced even if it cannot be read.
  const bool damaged = found.kind == Found::Kind::damaged;
  if (found.kind == Found::Kind::other || (damaged && k > 0)) refuse("not a dataset");
  if (!damaged && found.shard != k) refuse(fmt::format("file {} of another dataset", found.shard));
}

std::vector<std::string> later_files(const std::string& path, std::size_t first) {
  std::vector<std::string> names;
  const Found whole = found_at(path);
  for (std::size_t k = first; k < whole.shards && stands(shard_path(path, k)); ++k) {
    const Found found = found_at(shard_path(path, k));
    if (found.kind == Found::Kind::dataset && found.shard == k && found.dataset == whole.dataset) {
      names.push_back(shard_path(path, k));
    }
  }
  return names;
}

}  // namespace slipbench
