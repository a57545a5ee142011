#include "tests/tools/cli/commands/child_process.h"

#include <fcntl.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace slipbench {
namespace {

// In the child: executes the program `words[0]`.
[[noreturn]] void execute(std::vector<std::string> words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(pointers.front(), pointers.data());
  _exit(127);
}

std::vector<std::string> program_with(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{SLIPBENCH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

int exit_status(pid_t child) {
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

// True if `signal` is in a mask of a process in /proc/PID/status, such as
// "SigCgt:\t0000000000000002": SigCgt holds the caught signals, SigIgn the ignored ones.
bool in_mask(pid_t child, const std::string& name, int signal) {
  const std::string status = bytes_of("/proc/" + std::to_string(child) + "/status");
  const std::size_t at = status.find(name);
  return at != std::string::npos && (std::stoull(status.substr(at + name.size()), nullptr, 16) >> (signal - 1) & 1U) != 0;
}

// Number of threads of a process; 0 once it has ended.
std::ptrdiff_t threads_of(pid_t child) {
  std::error_code error;
  return std::distance(std::filesystem::directory_iterator("/proc/" + std::to_string(child) + "/task", error), {});
}

pid_t start_into_files(const std::vector<std::string>& words, const std::string& out, const std::string& err) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {
    dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    execute(words);
  }
  return child;
}

}  // namespace

ChildResult run_program_file(const std::vector<std::string>& arguments, const std::string& out) {
  const TemporaryFolder folder;
  const int status = exit_status(start_into_files(program_with(arguments), out.empty() ? folder / "out" : out, folder / "err"));
  return {status, out.empty() ? bytes_of(folder / "out") : "", bytes_of(folder / "err")};
}

ChildResult run_shell(const std::string& script, const std::string& folder) {
  const TemporaryFolder streams;
  const std::string text = "slipbench() { " SLIPBENCH_PROGRAM " \"$@\"; }; cd \"$1\" || exit; " + script;
  const int status = exit_status(start_into_files({"/bin/sh", "-c", text, "sh", folder}, streams / "out", streams / "err"));
  return {status, bytes_of(streams / "out"), bytes_of(streams / "err")};
}

ChildResult run_program_terminal(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  winsize size{};
  size.ws_row = 40;
  size.ws_col = 120;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child < 0) throw std::runtime_error("forkpty failed");
  if (child == 0) {
    unsetenv("NO_COLOR");
    setenv("TERM", "xterm", 1);
    for (const std::string& entry : environment) {
      const std::size_t equals = entry.find('=');
      setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
    }
    execute(program_with(arguments));
  }
  ChildResult result;
  char buffer[4096];
  // The read fails when the child has closed the terminal.
  for (ssize_t count = read(terminal, buffer, sizeof buffer); count > 0; count = read(terminal, buffer, sizeof buffer)) {
    result.out.append(buffer, static_cast<std::size_t>(count));
  }
  result.status = exit_status(child);
  close(terminal);
  return result;
}

ChildResult run_program_interrupted(const std::vector<std::string>& arguments, const std::string& ready, int signal) {
  const TemporaryFolder folder;
  const pid_t child = start_into_files(program_with(arguments), folder / "out", folder / "err");
  const auto is_ready = [&] {
    if (ready == "started") return in_mask(child, "SigCgt:", signal);
    if (ready == "threads") return threads_of(child) > 1;
    return std::filesystem::exists(ready);
  };
  for (int waited_ms = 0; waited_ms < 20000 && !is_ready(); waited_ms += 5) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  kill(child, signal);
  const int status = exit_status(child);
  return {status, bytes_of(folder / "out"), bytes_of(folder / "err")};
}

}  // namespace slipbench
