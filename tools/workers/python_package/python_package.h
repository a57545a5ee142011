// Runs parts of a command that are written in Python: the program becomes `python -m MODULE FILE`.
#pragma once

#include <string>

#include "tools/dataset/record/json.h"

namespace slipbench {

// A module of the package `slipbench`.
//
// The interpreter is that of SLIPBENCH_PYTHON, which the package sets when it runs the program
// (python/slipbench/__main__.py). Without that variable it is build/venv of the program's
// build.
class PythonModule {
 public:
  // `name`: "slipbench._export", a package with a file __main__.py, or "slipbench._train", a file.
  // `purpose`: the feature that needs it, which begins errors ("--format parquet"). `extra`: of
  // pip's `slipbench[EXTRA]`, for the module's further imports; empty: none.
  // Throws InputError with a remedy if the package or the module is missing.
  PythonModule(std::string name, std::string purpose, const std::string& extra);

  // Command that installs the module's imports.
  [[nodiscard]] const std::string& install() const { return install_; }

  // Replaces this process by `python -m NAME FILE`; FILE holds the request as JSON. SIGINT, SIGTERM
  // and SIGHUP are blocked until the module unblocks them (slipbench/_program.py), since Python
  // takes a while to start. Throws InputError if it cannot start, and for a text that is not UTF-8,
  // such as the name of a folder in Latin-1.
  [[noreturn]] void start(const Json& request) const;

 private:
  std::string name_, purpose_;
  std::string program_;  // interpreter
  std::string folder_;   // contains the package
  std::string install_;
};

}  // namespace slipbench
