// Work in child processes: for what may end its process, and for libraries that bear one thread only.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace slipbench {

// How a child process ended.
struct ChildEnd {
  enum class Kind : char {
    result = 'r',
    bad_input = 'i',  // threw InputError
    no_memory = 'm',  // std::bad_alloc
    failure = 'f',    // another exception
    broken = 'b',     // it ended without a word, or was ended
  };
  Kind kind = Kind::broken;
  std::string text;  // what it returned, or the exception's words
  int status = 0;    // waitpid's
};

// A copy of this process that does one thing. It ends with its parent, and a Ctrl-C of the terminal is the parent's affair. Call it while this
// process has no other thread.
class ChildProcess {
 public:
  // Throws std::runtime_error where the system gives no process.
  explicit ChildProcess(const std::function<std::string()>& action);
  ~ChildProcess();  // kills it where it has not ended
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&&) = delete;

  // A descriptor that is readable where read() has something to do.
  [[nodiscard]] int channel() const { return channel_; }
  // Takes what it has sent so far, waiting for the first of it; false: it sends no more.
  bool read();
  // Waits for its end, after read() gave false.
  ChildEnd end();

 private:
  int channel_ = -1, process_ = -1;
  std::string sent_;
};

// Does work 0 to count - 1, up to `jobs` at a time, each in a child process of its own, and returns what each returned, in this order: whatever
// `jobs`, each begins with the memory of this process as it is now. `begun` is told of the number of each work before it begins, `done` of each that
// has ended, and of what it returned; it may be empty. Rethrows what work threw: InputError as such, others as std::runtime_error; throws
// Interrupted once `interrupt` is set. No child outlives it.
std::vector<std::string> run_in_processes(std::size_t count, std::size_t jobs,
                                          const std::function<std::string(std::size_t)>& work,
                                          const std::function<void(std::size_t)>& begun, const std::atomic<bool>& interrupt,
                                          const std::function<void(std::size_t, const std::string&)>& done = {});

}  // namespace slipbench
