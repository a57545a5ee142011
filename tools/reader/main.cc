// slipbench-reader KIND PATH: reads a file completely. Prints the names of a dataset's files, or
// the reason why the file is invalid, and then a ReaderVerdict. Damage may crash the program before
// it prints the verdict. check_readable.h starts it.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <system_error>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "detectors/network/engine.h"
#include "sim/core/error.h"
#include "sim/core/process/check_readable.h"
#include "tools/dataset/content_check.h"
#include "tools/dataset/header.h"
#include "tools/dataset/reader.h"
#ifdef SLIPBENCH_WITH_MUJOCO
#include "sim/mujoco/mjcf.h"
#endif

namespace slipbench {
namespace {

// Damage can make HDF5 loop endlessly. Limit: 8 s of processor time, plus 2 s per MB of a dataset's
// files.
void limit_time(const std::string& path) {
  constexpr std::uint64_t megabyte = 1'000'000;
  std::uint64_t bytes = 0;
  std::error_code error;
  for (std::size_t k = 0;; ++k) {
    const std::uintmax_t size = std::filesystem::file_size(shard_path(path, k), error);
    if (error) break;
    bytes += size;
  }
  std::signal(SIGXCPU, SIG_DFL);
  rlimit limit{};
  ::getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 8 + 2 * bytes / megabyte);
  ::setrlimit(RLIMIT_CPU, &limit);
  constexpr rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
}

// The message for a file that needs more memory; prepared, because writing it may not allocate.
std::string too_large;

// Data of this process [bytes].
rlim_t own_data() {
  std::ifstream file("/proc/self/statm");
  rlim_t pages = 0;
  for (int field = 0; field < 6; ++field) file >> pages;  // size, resident, shared, text, lib, data
  return file ? pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) : 0;
}

// A small file may declare any amount of memory. The limit counts data (RLIMIT_DATA), not addresses
// (RLIMIT_AS): threads of OpenVINO reserve addresses that they never use. A dataset may need what
// the machine has.
void limit_memory(const std::string& kind, const std::string& path) {
  const bool bounded = kind == reader_word(FileKind::network) || kind == reader_word(FileKind::model);
  rlimit limit{};
  ::getrlimit(RLIMIT_DATA, &limit);
  const auto installed = static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, bounded ? most_reader_memory : installed);
  if (own_data() > limit.rlim_cur) return;  // under the address sanitizer, which maps terabytes
  ::setrlimit(RLIMIT_DATA, &limit);
  if (!bounded) return;
  too_large = path + ": needs more than " + reader_memory_text + " of memory, the most that is allowed" +
              static_cast<char>(ReaderVerdict::refused);
  // Libraries that catch std::bad_alloc would report something else, or crash.
  std::set_new_handler([] {
    [[maybe_unused]] const ssize_t written = ::write(STDOUT_FILENO, too_large.data(), too_large.size());
    ::_exit(0);
  });
}

void print_files(const DatasetReader& reader) {
  for (const std::string& file : reader.files()) std::fwrite(file.c_str(), 1, file.size() + 1, stdout);
}

void read_header(const std::string& path) {
  const DatasetReader reader(path);
  static_cast<void>(reader.split());
  print_files(reader);
}

void read_dataset(const std::string& path) {
  const DatasetReader reader(path);
  ContentCheck check(reader);
  for (const std::size_t trial : reader.trials()) {
    static_cast<void>(reader.info(trial));
    check.add(trial);
  }
  static_cast<void>(reader.split());
  check.finish();
  print_files(reader);
}

void read_batch(const std::string& path) {
  const DatasetReader reader = DatasetReader::of_file(path);
  if (reader.content_sha256().front().empty()) throw InputError(path + ": is damaged: it has no content_sha256");
  for (const std::size_t trial : reader.trials()) static_cast<void>(reader.read_trial(trial));
  check_content(reader);
}

void read(const std::string& kind, const std::string& path) {
  if (kind == reader_word(FileKind::dataset_file)) {
    static_cast<void>(file_about(path));
  } else if (kind == reader_word(FileKind::dataset_header)) {
    read_header(path);
  } else if (kind == reader_word(FileKind::dataset)) {
    read_dataset(path);
  } else if (kind == reader_word(FileKind::batch)) {
    read_batch(path);
  } else if (kind == reader_word(FileKind::network)) {
    static_cast<void>(network::load_engine_unchecked(path));
#ifdef SLIPBENCH_WITH_MUJOCO
  } else if (kind == reader_word(FileKind::model)) {
    try_mjcf(path);
#endif
  } else {
    throw InputError("unknown kind " + quote(kind));
  }
}

ReaderVerdict judge(const std::string& kind, const std::string& path) {
  try {
    limit_time(path);
    limit_memory(kind, path);
    read(kind, path);
    return ReaderVerdict::readable;
  } catch (const NotChecked& error) {
    std::fputs(error.what(), stdout);
    return ReaderVerdict::not_checked;
  } catch (const std::bad_alloc&) {
    std::fputs("out of memory", stdout);
    return ReaderVerdict::not_checked;
  } catch (const std::exception& error) {
    std::fputs(error.what(), stdout);
    return ReaderVerdict::refused;
  }
}

int run(int count, char** words) {
  constexpr int wanted = 3, wrong_usage = 2;
  if (count != wanted) {
    std::fputs("usage: slipbench-reader KIND PATH; slipbench starts it\n", stdout);
    return wrong_usage;
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::fputc(static_cast<char>(judge(words[1], words[2])), stdout);
  return std::fflush(stdout) == 0 ? 0 : wrong_usage;
}

}  // namespace
}  // namespace slipbench

int main(int count, char** words) { return slipbench::run(count, words); }
