#include "tools/base/dataset/guarded.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>

#include <fmt/format.h>

#include "sim/core/process/interrupted.h"
#include "tools/base/dataset/header.h"
#include "tools/base/files/reject.h"
#include "tools/base/workers/child_process.h"

namespace slipbench {
namespace {

void set_limits(const ReadingLimits& limits) {
  constexpr rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  rlimit cpu{};
  ::getrlimit(RLIMIT_CPU, &cpu);
  cpu.rlim_cur = std::min<rlim_t>(cpu.rlim_max, limits.cpu);
  ::setrlimit(RLIMIT_CPU, &cpu);
  limit_memory(limits.memory);
}

// What the child hands back; empty: it took longer than `seconds`. They are counted while this process runs, so that one that is stopped
// (Ctrl-Z) and goes on has them still.
std::optional<ChildEnd> end_of(ChildProcess& child, std::uint64_t seconds) {
  constexpr std::uint64_t looks = 10;  // a second, at which an interrupt is seen
  for (std::uint64_t left = looks * seconds;;) {
    end_if_interrupted();
    pollfd ready{child.channel(), POLLIN, 0};
    const int count = ::poll(&ready, 1, 1000 / static_cast<int>(looks));
    if (count == 0 && left-- == 0) return std::nullopt;
    if (count > 0 && !child.read()) return child.end();
  }
}

bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT || signal == SIGFPE || signal == SIGILL;
}

}  // namespace

ReadingLimits reading_limits(const std::string& path) {
  std::uint64_t bytes = 0;
  std::error_code error;
  for (std::size_t k = 0;; ++k) {
    const std::uintmax_t size = std::filesystem::file_size(sibling_path(path, k), error);
    if (error) break;
    bytes += size;
  }
  constexpr std::uint64_t megabyte = 1'000'000;
  return {8 + 2 * bytes / megabyte, 120 + 20 * bytes / megabyte, 8000 * megabyte + 16 * bytes};
}

std::string guarded(const std::string& subject, const std::function<std::string()>& action) {
  return guarded(subject, reading_limits(subject), action);
}

std::string guarded(const std::string& subject, const ReadingLimits& limits, const std::function<std::string()>& action) {
  ChildProcess child([&] {
    std::signal(SIGXCPU, SIG_DFL);
    set_limits(limits);
    return action();
  });
  const std::optional<ChildEnd> end = end_of(child, limits.wait);
  const auto unreadable = [&subject](const std::string& why) {
    return InputError(fmt::format("{}: cannot be read: {}", subject, why));
  };
  if (!end) throw unreadable(fmt::format("reading took longer than {} s", limits.wait));
  if (WIFSIGNALED(end->status) && WTERMSIG(end->status) == SIGXCPU) {
    throw unreadable(fmt::format("reading took longer than {} s of the processor", limits.cpu));
  }
  if (WIFSIGNALED(end->status) && !is_crash(WTERMSIG(end->status))) {
    throw std::runtime_error(fmt::format("{}: reading it was ended: {}", subject, ::strsignal(WTERMSIG(end->status))));
  }
  switch (end->kind) {
    case ChildEnd::Kind::bad_input: throw InputError(end->text);
    case ChildEnd::Kind::no_memory:
      throw unreadable(fmt::format("reading needed more than {:.3g} GB", 1e-9 * static_cast<double>(limits.memory)));
    case ChildEnd::Kind::failure: throw std::runtime_error(end->text);
    case ChildEnd::Kind::broken:
      reject("{}: is damaged, or there was too little memory: HDF5 crashed on it{}", subject,
             WIFSIGNALED(end->status) ? fmt::format(" ({})", ::strsignal(WTERMSIG(end->status))) : "");
    case ChildEnd::Kind::result: break;
  }
  return end->text;
}

void ContentCheck::add(std::size_t trial) {
  const std::size_t file = reader_->file_of(trial);
  const Digest found = reader_->stored_digest(trial);
  const std::string written = reader_->trial_sha256(trial);
  if (reader_->schema(file) > 1 && hexadecimal(found) != written) {
    reject("{}: /data/demo_{}: is damaged: its content has the SHA-256 {}, its attribute sha256 says {}", reader_->files()[file],
           trial, hexadecimal(found), written);
  }
  digests_[file].emplace_back(trial, found);
}

void ContentCheck::finish(std::size_t file) const {
  const std::string& written = reader_->content_sha256()[file];
  if (reader_->schema(file) == 1) {
    std::fprintf(stderr,
                 "slipbench: %s: schema 1: its digest covers arrays alone, so attributes such as onset_time_s go unchecked\n",
                 printable(reader_->files()[file]).c_str());
  }
  if (written.empty()) return;
  const std::string found = reader_->stored_sha256(file, digests_[file]);
  if (found == written) return;
  reject("{}: is damaged: its content has the SHA-256 {}, content_sha256 says {}", reader_->files()[file], found, written);
}

void ContentCheck::finish() const {
  for (std::size_t file = 0; file < digests_.size(); ++file) finish(file);
}

DatasetReader whole_dataset(const std::string& path) {
  DatasetReader reader(path);
  if (!reader.complete()) throw InputError(path + ": its run did not come to its end; allowed: a whole dataset");
  if (reader.trials().empty()) throw InputError(path + ": holds no trial");
  return reader;
}

void for_each_trial(const DatasetReader& reader, const std::function<void(const TrialRecord& record)>& use) {
  ContentCheck check(reader);
  for (const std::size_t trial : reader.trials()) {
    reader.check_recorded(trial);
    const TrialRecord record = reader.read_trial(trial);
    check.add(trial);
    use(record);
  }
  check.finish();
}

std::vector<std::string> checked_files(const std::string& path, bool content) {
  return Packed(guarded(path,
                        [&] {
                          const DatasetReader reader(path);
                          if (content) {
                            ContentCheck check(reader);
                            for (const std::size_t trial : reader.trials()) check.add(trial);
                            check.finish();
                          }
                          return Packed::bytes_of(reader.files());
                        }))
      .take<std::vector<std::string>>();
}

void check_content(const DatasetReader& reader, std::size_t file) {
  ContentCheck check(reader);
  for (const std::size_t trial : reader.trials()) {
    if (reader.file_of(trial) == file) check.add(trial);
  }
  check.finish(file);
}

std::string trial_identity(const DatasetReader& reader, std::size_t trial) {
  const std::string written = reader.trial_sha256(trial);
  return written.empty() ? hexadecimal(reader.stored_digest(trial)) : written;
}

}  // namespace slipbench
