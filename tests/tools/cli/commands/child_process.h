// Runs the built program and keeps what it says.
#pragma once

#include <string>
#include <vector>

#include "tests/files.h"

namespace slipbench {

struct ChildResult {
  int status = 0;  // exit status; 128 + signal when a signal ended it
  std::string out;
  std::string err;
};

// Runs `slipbench arguments...` with stdout and stderr in files: no terminal. `out`: where stdout goes instead, e.g. /dev/full.
ChildResult run_program_file(const std::vector<std::string>& arguments, const std::string& out = "");

// Runs `script` with sh in `folder`; the word slipbench there is the built program.
ChildResult run_shell(const std::string& script, const std::string& folder);

// The same as run_program_file with all streams on a terminal of 120 columns and `environment` ("NAME=value") added; everything it writes is in `out`.
ChildResult run_program_terminal(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {});

// Starts the program with its streams in files, sends `signal` as soon as `ready` exists ("started": as soon as the program catches that signal; "guarded": as soon as
// an InterruptGuard is there), and waits for the end.
ChildResult run_program_interrupted(const std::vector<std::string>& arguments, const std::string& ready, int signal);

}  // namespace slipbench
