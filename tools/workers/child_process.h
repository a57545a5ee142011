// Runs work in child processes, so that a crash, a call of exit() or an endless loop ends the child
// alone. Also for libraries that only one thread may use.
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

// fork(), or a replacement: Python has hooks to run before and after.
using Fork = std::function<pid_t()>;

// End of a child process.
struct ChildEnd {
  enum class Kind {
    result,     // the action returned
    bad_input,  // it threw InputError
    failure,    // it threw another exception
    lost,       // the process ended, or was killed, without an answer
  };
  Kind kind = Kind::lost;
  std::string text;      // return value, or the exception's message
  int status = 0;        // as reported by waitpid(); -1: unknown
  bool late = false;     // killed at the time limit
  bool corrupt = false;  // it ended normally, but its answer is not what it sent

  // "was ended by SIGSEGV (Segmentation fault)", "ended with status 0 before its work was done",
  // "was still running after 2 s, the limit", "returned an invalid result ...". `limit` [s].
  [[nodiscard]] std::string loss(double limit) const;
  // Returns the action's result. Throws InputError if the action did, InputError "SUBJECT: its
  // process was ended by ..." for a lost child, and std::runtime_error for any other exception of
  // the action.
  std::string result(const std::string& subject, double limit = std::numeric_limits<double>::infinity()) &&;
};

// Running child processes. Each is a copy of this process that runs one action, writes the result
// to a pipe and exits without clean-up. It leads its own process group, which is killed when the
// child has ended, and at the latest by this object's destructor, so that processes started by the
// action end too. Terminal signals and SIGTERM are ignored in children and handled by this process.
// Call it in a process without other threads, or with a `fork` that handles them.
class ChildProcesses {
 public:
  // `limit`: wall-clock time for an action [s].
  explicit ChildProcesses(double limit = std::numeric_limits<double>::infinity(), Fork fork = {});
  ~ChildProcesses();
  ChildProcesses(const ChildProcesses&) = delete;
  ChildProcesses& operator=(const ChildProcesses&) = delete;

  // Starts action() as number `index`. Throws InputError if the system cannot create a process.
  void start(std::size_t index, const std::function<std::string()>& action);
  [[nodiscard]] std::size_t running() const { return running_.size(); }
  // The next child that ended, with its number; waits until `deadline`, then returns nothing.
  std::optional<std::pair<std::size_t, ChildEnd>> wait_until(std::chrono::steady_clock::time_point deadline);

 private:
  struct Child {
    std::size_t index;
    pid_t process;
    int end;      // descriptor that is readable once the process has ended; -1: it ended before the descriptor was opened
    int channel;  // read end of the pipe; -1: all was read
    std::chrono::steady_clock::time_point begun;
    std::string sent;
  };
  static void read(Child& child);
  static ChildEnd end_of(Child& child);

  double limit_;
  Fork fork_;
  std::vector<Child> running_;
};

// Runs action() in a child process and returns its result. `limit`: time limit [s]. Throws as
// ChildEnd::result() does, and Interrupted once `interrupt`, which may be null, is set.
std::string run_in_child(const std::string& subject, const std::function<std::string()>& action,
                         const std::atomic<bool>* interrupt, double limit = std::numeric_limits<double>::infinity(),
                         const Fork& fork = {});

}  // namespace slipbench
