// The program behind main().
#pragma once

#include <string>
#include <vector>

#include "tools/program/cli/command.h"

namespace slipbench {

// Runs the command that `words`, those after the program's name, ask for and returns the exit status: 0 good, 1 a check failed,
// 2 bad input, 130 interrupted. Whatever goes wrong is one message on stderr.
int run_program(const Commands& commands, const std::vector<std::string>& words);

}  // namespace slipbench
