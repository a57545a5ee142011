// Parses a command line and runs its command.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command.h"

namespace slipbench {

// Parsed command line: help, version or a command.
struct Request {
  std::string help;            // text for stdout; empty: no help
  bool version = false;        // --version
  bool json = false;           // --json
  Command* command = nullptr;  // one of the given commands, with its options read; null: help or version
};

// Parses the words after the program's name. Throws InputError for an unknown command, option or
// format (with the nearest known one), a missing argument and an invalid number. Use each command
// once: its options keep their values.
Request parse_command_line(const Commands& commands, const std::vector<std::string>& words);

// Runs the command of `words`, those after the program's name, and returns the exit status: 0 good,
// 1 a check failed, 2 bad input, 130 interrupted. Every error is one message on stderr.
int run_program(const Commands& commands, const std::vector<std::string>& words);

}  // namespace slipbench
