// The program behind main().
#pragma once

#include <string>
#include <vector>

namespace slipbench {

// Runs the command that `arguments` (without the program's name) ask for and returns the exit status: 0 good, 1 a check failed,
// 2 bad input, 130 interrupted. Whatever goes wrong is one message on stderr.
int run_program(const std::vector<std::string>& arguments);

}  // namespace slipbench
