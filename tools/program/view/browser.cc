#include "tools/program/view/browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>
#include <vector>

namespace slipbench {
namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

bool has_screen() { return !variable("DISPLAY").empty() || !variable("WAYLAND_DISPLAY").empty(); }

std::vector<std::string> openers() {
  std::vector<std::string> found;
  std::istringstream list(variable("BROWSER"));
  for (std::string name; std::getline(list, name, ':');) {
    if (!name.empty()) found.push_back(name);
  }
  found.insert(found.end(), {"xdg-open", "open"});
  return found;
}

// Whether it has ended well or still runs after 3 s.
bool opened(pid_t child) {
  using namespace std::chrono_literals;
  for (const auto end = std::chrono::steady_clock::now() + 3s; std::chrono::steady_clock::now() < end;) {
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

// Starts `program path` in a session of its own, without this program's streams; -1 where there is no such program.
pid_t start(std::string program, std::string path) {
  std::array<char*, 3> words{program.data(), path.data(), nullptr};
  posix_spawn_file_actions_t streams;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawnattr_init(&attributes);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::posix_spawn_file_actions_addopen(&streams, stream, "/dev/null", O_RDWR, 0);
  }
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = -1;
  const bool started = ::posix_spawnp(&child, program.c_str(), &streams, &attributes, words.data(), environ) == 0;
  ::posix_spawn_file_actions_destroy(&streams);
  ::posix_spawnattr_destroy(&attributes);
  return started ? child : -1;
}

}  // namespace

std::optional<std::string> open_in_browser(const std::string& path) {
  if (!has_screen()) return std::nullopt;
  const std::string whole = std::filesystem::absolute(path).string();
  for (const std::string& program : openers()) {
    const pid_t child = start(program, whole);
    if (child > 0 && opened(child)) return program;
  }
  return std::nullopt;
}

}  // namespace slipbench
