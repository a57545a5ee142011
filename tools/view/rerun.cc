#include "tools/view/rerun.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>
#include <utility>

#include "sim/core/error.h"
#include "tools/dataset/checked_dataset.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/run_folder.h"
#include "tools/files/output_file.h"
#include "tools/files/reject.h"
#include "tools/formats/export/export.h"
#include "tools/workers/interrupt_guard.h"

namespace slipbench {
namespace {

namespace fs = std::filesystem;

// Starts a program in its own session, so that Ctrl-C ends the calling program alone.
// `streams(actions)` sets its streams. Returns 0, or errno of the failed start.
template <class Streams>
int start(std::vector<std::string> words, const Streams& streams, pid_t& child) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  streams(&actions);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  const int error = ::posix_spawnp(&child, words.front().c_str(), &actions, &attributes, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  return error;
}

// The user's Python with rerun.py, which receives file names on stdin.
class Python {
 public:
  Python(const std::string& name, const std::string& save) {
    const char* const own = std::getenv("SLIPBENCH_PYTHON");  // set if the package `slipbench` started the program
    // -P: no package of the user's current folder.
    std::vector<std::string> words{own == nullptr ? "python3" : own, "-P", "-c",
                                   std::string(page::embedded(view::assets(), "rerun.py")), name};
    if (!save.empty()) words.push_back(fs::absolute(save).string());
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) reject("cannot make a pipe: {}", std::strerror(errno));
    input_ = ends[1];
    const auto streams = [&ends](posix_spawn_file_actions_t* actions) {
      ::posix_spawn_file_actions_adddup2(actions, ends[0], STDIN_FILENO);
      ::posix_spawn_file_actions_adddup2(actions, STDERR_FILENO, STDOUT_FILENO);
    };
    const int error = start(words, streams, child_);
    ::close(ends[0]);
    if (error != 0) {
      ::close(input_);
      reject("view: --rerun needs Python with rerun-sdk; cannot start {}: {}", words.front(), std::strerror(error));
    }
    ::signal(SIGPIPE, SIG_IGN);  // Python may end before it has read everything
  }
  ~Python() {
    if (input_ >= 0) static_cast<void>(wait());
  }
  Python(const Python&) = delete;
  Python& operator=(const Python&) = delete;

  // False if Python has ended.
  bool tell(const std::string& path) const {
    const std::string line = path + '\n';
    return ::write(input_, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  }

  // Exit status of Python after it has processed everything.
  int wait() {
    ::close(std::exchange(input_, -1));
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  pid_t child_ = -1;
  int input_ = -1;
};

// True if a run is writing the file, which the run then has locked.
bool is_being_written(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

// The trial of a file to show: the requested one, else the first or the last; empty if the file
// does not have it.
std::optional<std::size_t> trial_in(const std::string& path, const std::optional<std::size_t>& asked, bool last) {
  const DatasetReader reader = dataset_header_at(path);
  const std::vector<std::size_t>& trials = reader.trials();
  if (trials.empty()) return std::nullopt;
  if (!asked) return last ? trials.back() : trials.front();
  return std::ranges::binary_search(trials, *asked) ? asked : std::nullopt;
}

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::vector<std::string> openers() {
  std::vector<std::string> found;
  std::istringstream list(variable("BROWSER"));
  for (std::string name; std::getline(list, name, ':');) {
    if (!name.empty()) found.push_back(name);
  }
  found.insert(found.end(), {"xdg-open", "open"});
  return found;
}

// True if the child ended with status 0 or still runs after 3 s.
bool opened(pid_t child) {
  using namespace std::chrono_literals;
  for (const auto end = std::chrono::steady_clock::now() + 3s; std::chrono::steady_clock::now() < end;) {
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    std::this_thread::sleep_for(20ms);
  }
  return true;
}

}  // namespace

bool begins_as_rrd(std::string_view text) { return text.starts_with("RRF"); }

int status_of_rerun() { return Python("", "").wait(); }

RerunResult show_in_rerun(const std::string& path, const RerunOptions& options) {
  using namespace std::chrono_literals;
  const std::string lock = run_lock_path(path);
  const bool follows = is_being_written(lock);
  if (!follows && !fs::exists(path)) reject("view: {}: does not exist, and no run is writing it", path);
  const InterruptGuard guard("the viewer stays open");
  const ScratchFolder folder;  // files for Python
  Python python(fs::path(path).filename().string(), options.save);
  RerunResult result;
  for (bool alive = true, runs = follows; alive && !InterruptGuard::flag();) {
    // A trial finished after this check is found in the next pass, or in the complete file.
    runs = runs && is_being_written(lock);
    const std::string source = runs ? first_batch_path(path) : path;
    if (runs && !fs::exists(source)) {  // the first batch is unfinished
      std::this_thread::sleep_for(500ms);
      continue;
    }
    try {
      const auto trial = trial_in(source, options.trial, follows);
      if (trial && (result.trials.empty() || *trial != result.trials.back())) {
        const std::vector<std::string> files =
            export_dataset(source, folder.path(),
                           {.format = ExportFormat::npz, .slip_rule = {}, .label_speed = {}, .sensors = {}, .trial = trial});
        alive = python.tell(files.front());
        result.trials.push_back(*trial);
      }
    } catch (const InputError&) {
      // A run that ends merges and removes its batches, possibly while they are read here; the next
      // pass reads the merged file.
      if (!runs) throw;
    }
    if (!runs || (options.trial && !result.trials.empty())) break;
    std::this_thread::sleep_for(500ms);
  }
  result.status = python.wait();
  if (result.status == 0 && result.trials.empty() && options.trial) reject("view: {}: no trial {}", path, *options.trial);
  return result;
}

std::optional<std::string> open_in_browser(const std::string& path) {
  if (variable("DISPLAY").empty() && variable("WAYLAND_DISPLAY").empty()) return std::nullopt;
  const std::string whole = std::filesystem::absolute(path).string();
  for (const std::string& program : openers()) {
    const auto none = [](posix_spawn_file_actions_t* actions) {
      for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        ::posix_spawn_file_actions_addopen(actions, stream, "/dev/null", O_RDWR, 0);
    };
    pid_t child = -1;
    if (start({program, whole}, none, child) == 0 && opened(child)) return program;
  }
  return std::nullopt;
}

}  // namespace slipbench
