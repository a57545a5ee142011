// Work in child processes: a crash, a call of exit() or a loop without end ends the child alone. Also for libraries that work right only where one
// thread uses them.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace slipbench {

// fork(), or a function that forks in its place: Python has hooks to run before and after.
using Fork = std::function<pid_t()>;

// How a child process ended.
struct ChildEnd {
  enum class Kind {
    result,     // it returned
    bad_input,  // it threw InputError
    failure,    // it threw another exception
    lost,       // it ended, or was ended, before it could say
  };
  Kind kind = Kind::lost;
  std::string text;   // what it returned, or the exception's message
  int status = 0;     // as waitpid() reports it; -1: not known
  bool late = false;  // it was ended because its time was over

  // "was ended by SIGSEGV (Segmentation fault)", "ended with status 0 before its work was done", "was still running after 2 s, the limit". `limit` [s].
  [[nodiscard]] std::string loss(double limit) const;
  // What it returned. Throws InputError where it did, for a lost one "SUBJECT: its process was ended by ...", all else as std::runtime_error.
  std::string result(const std::string& subject, double limit = std::numeric_limits<double>::infinity()) &&;
};

// Child processes at work. Each is a copy of this process that runs one action, writes the result to a pipe and ends without any clean-up. It leads
// a process group of its own, which is killed when the child has ended, and at the latest with this object: what the action has started ends, too.
// Signals of the terminal and SIGTERM are left to this process. Call it in a process without other threads, or with a `fork` that takes care of them.
class ChildProcesses {
 public:
  // `limit`: s on the clock that an action may take.
  explicit ChildProcesses(double limit = std::numeric_limits<double>::infinity(), Fork fork = {});
  ~ChildProcesses();
  ChildProcesses(const ChildProcesses&) = delete;
  ChildProcesses& operator=(const ChildProcesses&) = delete;

  // Starts action() as number `index`. Throws InputError where the system gives no process.
  void start(std::size_t index, const std::function<std::string()>& action);
  [[nodiscard]] std::size_t running() const { return running_.size(); }
  // The next that has ended, with its number; waits for it until `deadline`, then returns nothing.
  std::optional<std::pair<std::size_t, ChildEnd>> wait_until(std::chrono::steady_clock::time_point deadline);

 private:
  struct Child {
    std::size_t index;
    pid_t process;
    int end;      // descriptor that is readable once the process has ended; -1: it ended before it could be opened
    int channel;  // the pipe's end to read; -1: all has been read
    std::chrono::steady_clock::time_point begun;
    std::string sent;
  };
  static void read(Child& child);
  static ChildEnd end_of(Child& child);

  double limit_;
  Fork fork_;
  std::vector<Child> running_;
};

// Runs action() in a child process and returns its result. `limit`: s that it may take. Throws what ChildEnd::result() throws, and Interrupted once
// `interrupt` is set; it may be null.
std::string run_in_child(const std::string& subject, const std::function<std::string()>& action,
                         const std::atomic<bool>* interrupt, double limit = std::numeric_limits<double>::infinity(),
                         const Fork& fork = {});

}  // namespace slipbench
