#include "tools/base/dataset/dataset_target.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/process/check_readable.h"
#include "tools/base/dataset/header.h"
#include "tools/base/dataset/reader.h"
#include "tools/base/dataset/shard.h"
#include "tools/base/files/reject.h"
#include "tools/base/hdf5/crash_safe_file.h"

namespace slipbench {
namespace {

// What stands under a name.
struct Found {
  enum class Kind {
    nothing,
    empty,  // holds nothing to lose: no byte, or those of a dataset that was killed before it began
    dataset,
    damaged,  // HDF5 that cannot be read
    other,
  };
  Kind kind = Kind::nothing;
  std::uint64_t shard = 0;
  std::uint64_t shards = 0;  // 0: not noted
  std::uint64_t trials = 0;
  bool complete = false;
  std::string dataset{};  // the same for all files of one
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
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  return {Found::Kind::dataset,
          about->shard,
          about->shards.value_or(0),
          about->trials,
          about->complete && hdf5::CrashSafeFile::cleared(file.get()),
          fmt::format("{}\n{}\n{}", header.seed, header.command, header.scene)};
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
  constexpr Beginning hdf5{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  const std::optional<Beginning> beginning = beginning_of(path);
  if (beginning == Beginning{}) return {Found::Kind::empty};
  if (beginning != hdf5) return {Found::Kind::other};
  try {
    return found_dataset(path);
  } catch (const InputError&) {
    return {Found::Kind::damaged};
  }
}

// What a run that did not come to its end may have left as the k-th file. A later file may say that it is complete: the first one
// is finished last, and says it for all.
bool is_leftover(const Found& found, std::size_t k) {
  if (found.kind == Found::Kind::empty) return true;
  return found.kind == Found::Kind::dataset && (!found.complete || (k > 0 && found.shard == k));
}

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& allowed) {
  reject("cannot write {}: {}; allowed: {}", path, what, allowed);
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
void check_leftover_name(const std::string& path, std::size_t k, const std::string& name, const char* use, bool resumes) {
  check_target(name);
  const bool temporary = name == temporary_path(shard_path(path, k));
  // Another run may hold the lock; one that resumes has locked what it goes on with itself.
  if ((temporary || !resumes) && type_of(name) == std::filesystem::file_type::regular) static_cast<void>(lock_file(name));
  const Found found = found_at(name);
  if (found.kind == Found::Kind::nothing) return;
  const std::string allowed = fmt::format("a new name, or {} moved away", name);
  // Under its temporary name even a whole dataset is what a run has left, which was ended before the renaming.
  const bool nameless = temporary && found.kind == Found::Kind::dataset;
  if (is_leftover(found, k) || nameless) {
    if (resumes || found.trials == 0) return;
    refuse(path,
           fmt::format("{} holds {} trial{} of a run that did not come to its end", name, found.trials,
                       found.trials == 1 ? "" : "s"),
           "--resume, which goes on with what is there, " + allowed);
  }
  const char* what = found.kind == Found::Kind::dataset   ? "holds a complete dataset"
                     : found.kind == Found::Kind::damaged ? "cannot be read"
                                                          : "is no dataset";
  refuse(path, fmt::format("{}, {}, exists and {}", name, use, what), allowed);
}

void check_names(const std::string& path, std::size_t k, bool resumes) {
  check_own_name(path, k);
  check_leftover_name(path, k, temporary_path(shard_path(path, k)), "its name while it is written", resumes);
  check_leftover_name(path, k, shard_path(kept_path(path), k), "its name after an interrupt", resumes);
}

std::array<std::string, 3> names_of(const std::string& path, std::size_t k) {
  const std::string own = shard_path(path, k);
  return {own, temporary_path(own), shard_path(kept_path(path), k)};
}

template <class Name>
void remove_leftovers(std::size_t first, const Name& name_of) {
  for (std::size_t k = first; is_leftover(found_at(name_of(k)), k); ++k) ::unlink(name_of(k).c_str());
}

}  // namespace

std::size_t check_dataset_targets(const std::string& path, std::size_t planned, bool resumes) {
  std::size_t k = 0;
  for (; k < planned; ++k) check_names(path, k, resumes);
  // Further files come where trials are large. Most runs do not get there, and what stands in the way is theirs to meet.
  const auto any_stands = [&] {
    for (const std::string& name : names_of(path, k)) {
      if (stands(name)) return true;
    }
    return false;
  };
  for (; any_stands(); ++k) {
    try {
      check_names(path, k, resumes);
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

bool finish_names(const std::string& path) {
  const Found first = found_at(temporary_path(path));
  if (first.kind != Found::Kind::dataset || !first.complete) return false;
  std::size_t count = 0;
  while (found_at(temporary_path(shard_path(path, count))).kind == Found::Kind::dataset) ++count;
  for (std::size_t k = 0; k < count; ++k) check_own_name(path, k);
  for (std::size_t k = count; k-- > 0;) rename_file(temporary_path(shard_path(path, k)), shard_path(path, k));
  remove_kept(path, 0);
  return true;
}

std::vector<Leftover> leftovers(const std::string& path) {
  std::vector<Leftover> left;
  for (const std::string& name : {temporary_path(path), kept_path(path)}) {
    if (type_of(name) != std::filesystem::file_type::regular) continue;
    Descriptor lock = lock_file(name);
    const Found found = found_at(name);
    if (found.kind == Found::Kind::damaged) reject("cannot resume {}: {} cannot be read", path, name);
    const bool is_left = is_leftover(found, 0) || (found.kind == Found::Kind::dataset && name == temporary_path(path));
    if (is_left && found.trials > 0) left.push_back({name, std::move(lock)});
  }
  return left;
}

std::size_t gather_leftovers(const std::string& path) {
  std::size_t k = 0;
  for (;; ++k) {
    const auto [own, temporary, kept] = names_of(path, k);
    const Found written = found_at(temporary);
    const Found before = found_at(kept);
    const bool has_written = written.kind == Found::Kind::dataset && written.trials > 0;
    const bool has_before = is_leftover(before, k) && before.trials > 0;
    if (!has_written && !has_before) return k;
    if (has_written && (!has_before || written.trials >= before.trials)) rename_file(temporary, kept);
  }
}

void remove_temporary(const std::string& path, std::size_t first) {
  remove_leftovers(first, [&](std::size_t k) { return temporary_path(shard_path(path, k)); });
}

void remove_kept(const std::string& path, std::size_t first) {
  remove_leftovers(first, [&](std::size_t k) { return shard_path(kept_path(path), k); });
}

}  // namespace slipbench
