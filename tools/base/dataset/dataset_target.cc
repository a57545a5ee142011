#include "tools/base/dataset/dataset_target.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/base/dataset/guarded.h"
#include "tools/base/dataset/header.h"
#include "tools/base/dataset/output_file.h"
#include "tools/base/dataset/reader.h"

namespace slipbench {
namespace {

// What stands under a name.
struct Found {
  enum class Kind {
    nothing,
    empty,  // holds nothing to lose
    dataset,
    damaged,  // HDF5 that cannot be read, as a crash may leave it
    other,
  };
  Kind kind = Kind::nothing;
  std::uint64_t shard = 0;
  std::uint64_t shards = 0;  // 0: not noted
  bool complete = false;
  std::string dataset{};  // the same for all files of one
};

bool begins_as_hdf5(const std::string& path) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::array<char, 8> found{};
  std::ifstream file(path, std::ios::binary);
  return file.read(found.data(), found.size()) && found == signature;
}

// Runs in the child process, which HDF5 may end.
std::string found_text(const std::string& path) {
  try {
    const std::optional<FileAbout> about = file_about(path);
    if (!about) return nlohmann::json{{"kind", Found::Kind::other}}.dump();
    const DatasetHeader& header = about->header;
    return nlohmann::json{{"kind", Found::Kind::dataset},
                          {"shard", about->shard},
                          {"shards", about->shards.value_or(0)},
                          {"complete", about->complete},
                          {"dataset", fmt::format("{}\n{}\n{}", header.seed, header.command, header.scene)}}
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  } catch (const std::exception&) {
    return nlohmann::json{{"kind", Found::Kind::damaged}}.dump();
  }
}

// A link is not followed.
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
  if (!begins_as_hdf5(path)) return {Found::Kind::other};
  try {
    const nlohmann::json json = nlohmann::json::parse(guarded(path, [&] { return found_text(path); }));
    return {json.at("kind").get<Found::Kind>(), json.value("shard", std::uint64_t{0}), json.value("shards", std::uint64_t{0}),
            json.value("complete", false), json.value("dataset", "")};
  } catch (const InputError&) {
    return {Found::Kind::damaged};
  }
}

// What a run that did not come to its end may have left.
bool is_leftover(const Found& found) {
  return found.kind == Found::Kind::empty || found.kind == Found::Kind::damaged ||
         (found.kind == Found::Kind::dataset && !found.complete);
}

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& allowed) {
  throw InputError(fmt::format("cannot write {}: {}; allowed: {}", path, what, allowed));
}

// The k-th file's own name.
void check_own_name(const std::string& path, std::size_t k) {
  const std::string name = shard_path(path, k);
  check_target(name);
  const Found found = found_at(name);
  if (found.kind == Found::Kind::nothing || found.kind == Found::Kind::empty) return;
  const std::string subject = k == 0 ? "it" : fmt::format("{}, the dataset's file {},", name, k);
  constexpr const char* allowed = "a new name, or a dataset to replace";
  // The user has named the first file, and so may give up one that cannot be read.
  const bool damaged = found.kind == Found::Kind::damaged;
  if (found.kind == Found::Kind::other || (damaged && k > 0)) refuse(path, subject + " exists and is no dataset", allowed);
  if (!damaged && found.shard != k) {
    refuse(path, fmt::format("{} exists and is file {} of another dataset", subject, found.shard), allowed);
  }
}

// A name that the run takes without having been given it.
void check_leftover_name(const std::string& path, const std::string& name, const char* use) {
  check_target(name);
  const Found found = found_at(name);
  if (found.kind == Found::Kind::nothing || is_leftover(found)) return;
  refuse(path,
         fmt::format("{}, {}, exists and {}", name, use,
                     found.kind == Found::Kind::other ? "is no dataset" : "holds a complete dataset"),
         fmt::format("a new name, or {} moved away", name));
}

void check_names(const std::string& path, std::size_t k) {
  check_own_name(path, k);
  check_leftover_name(path, temporary_path(shard_path(path, k)), "its name while it is written");
  check_leftover_name(path, shard_path(kept_path(path), k), "its name after an interrupt");
}

std::array<std::string, 3> names_of(const std::string& path, std::size_t k) {
  const std::string own = shard_path(path, k);
  return {own, temporary_path(own), shard_path(kept_path(path), k)};
}

template <class Name>
void remove_leftovers(std::size_t first, const Name& name_of) {
  for (std::size_t k = first; is_leftover(found_at(name_of(k))); ++k) ::unlink(name_of(k).c_str());
}

}  // namespace

std::size_t check_dataset_targets(const std::string& path, std::size_t planned) {
  std::size_t k = 0;
  for (; k < planned; ++k) check_names(path, k);
  // Further files come where trials are large. Most runs do not get there, and what stands in the way is theirs to meet.
  const auto any_stands = [&] {
    for (const std::string& name : names_of(path, k)) {
      if (stands(name)) return true;
    }
    return false;
  };
  for (; any_stands(); ++k) {
    try {
      check_names(path, k);
    } catch (const InputError&) {
      break;
    }
  }
  return k;
}

void check_names_are_free(const std::string& path, std::size_t k) {
  for (const std::string& name : names_of(path, k)) {
    if (stands(name)) refuse(path, fmt::format("it needs a file {}, and {} is in the way", k, name), "a new name");
  }
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

void remove_temporary(const std::string& path, std::size_t first) {
  remove_leftovers(first, [&](std::size_t k) { return temporary_path(shard_path(path, k)); });
}

void remove_kept(const std::string& path, std::size_t first) {
  remove_leftovers(first, [&](std::size_t k) { return shard_path(kept_path(path), k); });
}

}  // namespace slipbench
