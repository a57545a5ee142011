// Work of a command that is done in Python: the program becomes `python -m MODULE REQUEST`.
#pragma once

#include <string>

namespace slipbench {

// A module of the package `slipbench` that the program can become.
//
// The Python is the one that SLIPBENCH_PYTHON names, which is set where the package itself runs the program
// (tools/python/slipbench/__main__.py). Without that variable it is build/venv of the build that the program is in.
class PythonModule {
 public:
  // `name`: "slipbench._export", a package with a file __main__.py, or "slipbench._train", a file. `purpose`: what needs
  // it, with which errors begin ("--format parquet"). `extra`: of pip's `slipbench[EXTRA]`, what the module imports
  // beside the package; empty: nothing.
  // Throws InputError with the commands that build the package where it is not installed or has no extension.
  PythonModule(std::string name, std::string purpose, const std::string& extra);

  // The command that installs what the module imports.
  [[nodiscard]] const std::string& install() const { return install_; }

  // Replaces this process by `python -m NAME REQUEST`. SIGINT, SIGTERM and SIGHUP are blocked until the module unblocks
  // them (slipbench/_program.py, Interrupt), since Python takes a while to start. Throws InputError when it cannot start.
  [[noreturn]] void start(std::string request) const;

 private:
  std::string name_, purpose_;
  std::string program_;  // interpreter
  std::string folder_;   // above the package
  std::string install_;
};

}  // namespace slipbench
