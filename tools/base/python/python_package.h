// Work of a command that is done in Python: the program becomes, or runs, `python -m MODULE REQUEST`.
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace slipbench {

// A module of the package `slipbench`.
//
// The Python is the one that SLIPBENCH_PYTHON names, which is set where the package itself runs the program
// (tools/python/slipbench/__main__.py). Without that variable it is build/venv of the build that the program is in.
class PythonModule {
 public:
  // `name`: "slipbench._export", a package with a file __main__.py, or "slipbench._train", a file. `purpose`: what needs
  // it, with which errors begin ("--format parquet"). `extra`: of pip's `slipbench[EXTRA]`, what the module imports
  // beside the package; empty: nothing.
  // Throws InputError with what would help where the package or the module is not there.
  PythonModule(std::string name, std::string purpose, const std::string& extra);

  // The command that installs what the module imports.
  [[nodiscard]] const std::string& install() const { return install_; }

  // Replaces this process by `python -m NAME REQUEST`. SIGINT, SIGTERM and SIGHUP are blocked until the module unblocks
  // them (slipbench/_program.py, Interrupt), since Python takes a while to start. Throws InputError when it cannot start.
  [[noreturn]] void start(std::string request) const;

  // Shows the user the module's stderr, or hides it.
  enum class Errors { shown, hidden };
  // Runs it as a child process, whose stdout is discarded, and returns its exit status, 128 + the signal where one ended
  // it. The child is killed once `interrupt` is set, which may be null: what it writes must be worth nothing then. It has
  // a process group of its own, so a terminal's Ctrl-C reaches this process alone. Throws InputError when it cannot start.
  [[nodiscard]] int run(std::string request, Errors errors, const std::atomic<bool>* interrupt) const;

 private:
  [[nodiscard]] std::vector<std::string> words(std::string request) const;
  [[noreturn]] void reject_start(int reason) const;

  std::string name_, purpose_;
  std::string program_;  // interpreter
  std::string folder_;   // above the package
  std::string install_;
};

}  // namespace slipbench
