#include "sim/core/process/check_readable.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sim/core/error.h"
#include "sim/core/process/interrupted.h"
#include "sim/core/process/own_library.h"

namespace slipbench {
namespace {

// Signals by which a damaged file ends the reader. All others come from outside: a user, or the
// system when memory is short.
bool is_crash(int signal) {
  return signal == SIGSEGV || signal == SIGBUS || signal == SIGABRT || signal == SIGFPE || signal == SIGILL;
}

// A running slipbench-reader and the pipe to which it writes its message.
class Reader {
 public:
  Reader(FileKind kind, const std::string& path) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw NotChecked(path + ": cannot be read: " + std::strerror(errno));
    channel_ = ends[0];
    std::string program = own_path("slipbench-reader"), word = reader_word(kind), file = path;
    char* const words[] = {program.data(), word.data(), file.data(), nullptr};
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    // Libraries print parts of a file before they crash.
    ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int error = ::posix_spawn(&process_, program.c_str(), &actions, nullptr, words, environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    if (error == 0) return;
    ::close(channel_);
    throw NotChecked(path + ": cannot be read: cannot start " + program + ": " + std::strerror(error));
  }
  ~Reader() {
    ::close(channel_);
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    static_cast<void>(status());
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  // Returns all that the reader writes.
  std::string message() {
    std::string text;
    while (true) {
      end_if_interrupted();
      constexpr int poll_interval = 100;  // ms
      pollfd ready{channel_, POLLIN, 0};
      if (::poll(&ready, 1, poll_interval) <= 0) continue;
      char buffer[4096];
      const ssize_t count = ::read(channel_, buffer, sizeof buffer);
      if (count > 0) text.append(buffer, static_cast<std::size_t>(count));
      if (count == 0) return text;
    }
  }
  // Waits for the reader's end and returns its status.
  int status() {
    int status = -1;  // kept if other code waits for this process's children: no exit, no signal
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
    process_ = -1;
    return status;
  }

 private:
  pid_t process_ = -1;
  int channel_ = -1;
};

}  // namespace

std::string reader_word(FileKind kind) {
  switch (kind) {
    case FileKind::dataset_file: return "dataset-file";
    case FileKind::dataset_header: return "dataset-header";
    case FileKind::dataset: return "dataset";
    case FileKind::batch: return "batch";
    case FileKind::network: return "network";
    case FileKind::model: return "model";
  }
  throw std::logic_error("a kind of file without a name");
}

std::string check_readable(FileKind kind, const std::string& path) {
  Reader reader(kind, path);
  std::string message = reader.message();
  const int status = reader.status();
  // Uses the verdict, not the exit status: in a program that waits for all children, or ignores
  // SIGCHLD, there is no status.
  const char verdict = message.empty() ? '\0' : message.back();
  if (!message.empty()) message.pop_back();
  if (verdict == static_cast<char>(ReaderVerdict::readable)) return message;
  if (verdict == static_cast<char>(ReaderVerdict::refused)) throw InputError(message);
  if (verdict == static_cast<char>(ReaderVerdict::not_checked)) throw NotChecked(path + ": cannot be read: " + message);
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGINT || signal == SIGTERM || signal == SIGHUP) throw Interrupted();
  if (signal == SIGXCPU) throw InputError(path + ": is damaged: reading it does not end");
  if (is_crash(signal)) {
    // Without memory MuJoCo crashes.
    const bool bounded = kind == FileKind::network || kind == FileKind::model;
    throw InputError(path + ": is damaged" +
                     (bounded ? " or needs more than " + std::string(reader_memory_text) + " of memory" : "") +
                     ": reading it crashed (" + ::strsignal(signal) + ")");
  }
  throw NotChecked(path + ": cannot be read: slipbench-reader was stopped" +
                   (signal == 0 ? "" : " (" + std::string(::strsignal(signal)) + ")"));
}

void check_readable_once(FileKind kind, const std::string& path) {
  using Stamp = std::tuple<FileKind, std::string, std::uintmax_t, std::filesystem::file_time_type>;
  static std::mutex mutex;
  static std::set<Stamp> checked;
  std::error_code gone;  // the reader reports it
  Stamp stamp(kind, path, std::filesystem::file_size(path, gone), std::filesystem::last_write_time(path, gone));
  const std::lock_guard lock(mutex);
  if (checked.contains(stamp)) return;
  check_readable(kind, path);
  checked.insert(std::move(stamp));
}

}  // namespace slipbench
