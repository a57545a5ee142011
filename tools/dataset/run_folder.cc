#include "tools/dataset/run_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <regex>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "tools/dataset/header.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

// Regular files of a folder, by name. An unreadable folder counts as empty.
std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.symlink_status(error).type() == fs::file_type::regular) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

bool is_batch(const fs::path& file) {
  static const std::regex name(R"(batch(-\d+)?\.h5)");
  return std::regex_match(file.filename().string(), name);
}

bool is_damaged(const fs::path& file) { return file.extension() == ".damaged" && is_batch(file.stem()); }

bool is_unfinished(const fs::path& file) { return file.filename().string().ends_with(".h5.partial"); }

// Throws InputError unless `folder` was made by a run or is empty.
void check_own(const std::string& target, const std::string& folder, const std::string& lock) {
  std::error_code error;
  const bool is_folder = fs::symlink_status(folder, error).type() == fs::file_type::directory;
  const bool is_lock = fs::symlink_status(lock, error).type() == fs::file_type::regular && fs::file_size(lock, error) == 0;
  if (is_folder && (is_lock || fs::is_empty(folder, error))) return;
  reject(
      "cannot write {}: {}, the folder for unfinished work, exists and was not made by a run; choose a new name, or move {} away",
      target, folder, folder);
}

}  // namespace

std::string run_folder_path(const std::string& path) { return temporary_path(path); }

std::string run_lock_path(const std::string& path) { return run_folder_path(path) + "/lock"; }

std::string first_batch_path(const std::string& path) { return run_folder_path(path) + "/batch.h5"; }

RunFolder::RunFolder(const std::string& path) : target_(path), path_(run_folder_path(path)) {
  check_target(path);
  const std::string lock = run_lock_path(path);
  const bool made = ::mkdir(path_.c_str(), 0777) == 0;
  if (!made && errno != EEXIST) reject("cannot write {}: cannot make the folder {}: {}", path, path_, std::strerror(errno));
  if (!made) check_own(path, path_, lock);
  try {
    lock_ = lock_file(lock);
  } catch (const InputError&) {
    if (made) ::rmdir(path_.c_str());
    throw;
  }
  if (made) sync_folder_of(path_);
  for (const fs::path& file : files_in(path_)) {
    if (is_unfinished(file)) ::unlink(file.c_str());
  }
}

RunFolder::~RunFolder() { close(); }

void RunFolder::close() {
  if (lock_.get() < 0) return;
  const Descriptor lock = std::exchange(lock_, Descriptor());
  const std::vector<fs::path> files = files_in(path_);
  if (std::ranges::any_of(files, [](const fs::path& file) { return is_batch(file) || is_damaged(file); })) return;
  for (const fs::path& file : files) {
    if (is_unfinished(file)) ::unlink(file.c_str());
  }
  ::unlink(run_lock_path(target_).c_str());
  ::rmdir(path_.c_str());
}

std::string RunFolder::unfinished_file(std::size_t k) const {
  return temporary_path((fs::path(path_) / fs::path(shard_path(target_, k)).filename()).string());
}

std::string RunFolder::batch(std::size_t k) const { return shard_path(first_batch_path(target_), k); }

std::vector<std::string> RunFolder::batches() const {
  std::vector<std::string> names;
  for (const fs::path& file : files_in(path_)) {
    if (is_batch(file)) names.push_back(file.string());
  }
  // Sorted by number: the first has the shortest name, and "batch-10000.h5" follows
  // "batch-9999.h5".
  std::ranges::sort(names, {}, [](const std::string& name) { return std::pair(name.size(), name); });
  return names;
}

void RunFolder::refuse_batches() const {
  const std::size_t count = batches().size();
  if (count == 0) return;
  reject(
      "cannot write {}: {} contains {} batch{} of finished trials of an unfinished sweep; continue it with --resume, choose a new name, or move {} away",
      target_, path_, count, count == 1 ? "" : "es", path_);
}

void RunFolder::remove_batches() const {
  for (const fs::path& file : files_in(path_)) {
    if (is_batch(file) || is_damaged(file)) ::unlink(file.c_str());
  }
}

}  // namespace slipbench
