// Runs the built program and stores its output.
#pragma once

#include <string>
#include <vector>

#include "tests/files.h"

namespace slipbench {

struct ChildResult {
  int status = 0;  // exit status; 128 + the signal that ended it
  std::string out;
  std::string err;
};

// Runs `slipbench arguments...` with stdout and stderr in files, so without a terminal. `out`:
// replaces the file of stdout, e.g. /dev/full.
ChildResult run_program_file(const std::vector<std::string>& arguments, const std::string& out = "");

// Runs `script` with sh in `folder`; the word slipbench in it is the built program.
ChildResult run_shell(const std::string& script, const std::string& folder);

// As run_program_file, with all streams on a terminal of 120 columns and `environment`
// ("NAME=value") added; `out` holds everything that the program writes.
ChildResult run_program_terminal(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {});

// Starts the program with its streams in files, sends `signal` once `ready` exists ("started": once
// the program catches that signal; "threads": once it has several threads), and waits for the
// end.
ChildResult run_program_interrupted(const std::vector<std::string>& arguments, const std::string& ready, int signal);

}  // namespace slipbench
