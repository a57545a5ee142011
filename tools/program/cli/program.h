// The program behind main().
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/program/cli/command.h"

namespace slipbench {

// Runs the command that `words`, those after the program's name, ask for and returns the exit status: 0 good, 1 a check failed,
// 2 bad input, 130 interrupted. Whatever goes wrong is one message on stderr.
int run_program(const Commands& commands, const std::vector<std::string>& words);

// A command of another program, which stands in the same folder as this one.

// Appears in the help as every command does, and hands all its words, --help among them, to the other program. So the program that everybody
// builds first is built without the studies.
class CommandElsewhere final : public Command {
 public:
  // `program`: the name of its file.
  CommandElsewhere(std::string name, std::string summary, std::string program)
      : name_(std::move(name)), summary_(std::move(summary)), program_(std::move(program)) {}

  void declare(Arguments& arguments) override;
  // Does not return but where the other program is missing: InputError with the command that builds it.
  int run() override;

 private:
  std::string name_, summary_, program_;
  std::vector<std::string> words_;  // those after the command's name
};

}  // namespace slipbench
