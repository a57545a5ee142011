// The commands of the program, and how words become one of them.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace slipbench {

class Arguments;

inline constexpr int exit_good = 0;
inline constexpr int exit_check_failed = 1;
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_interrupted = 130;  // 128 + SIGINT, as shells count

// One command. Its options are members, with their defaults.
class Command {
 public:
  virtual ~Command() = default;

  // Declares its name, its help and its options, which are read into members of this object: it must outlive `arguments`.
  virtual void declare(Arguments& arguments) = 0;
  // Does what the options ask for, prints the result on stdout and returns the exit status. Throws InputError for bad input.
  virtual int run() = 0;

  // Whether stderr gets errors alone: neither progress nor what is being done.
  [[nodiscard]] bool silent() const { return quiet || json; }
  // Says on stderr what is being done ("slipbench: ..."), unless the command is silent.
  void tell(const std::string& what) const;

  bool json = false;   // --json, an option of every command
  bool quiet = false;  // --quiet, where the command declares it
};

// Commands in the order that the help shows them in.
using Commands = std::vector<std::unique_ptr<Command>>;

// One command of each kind, in this order.
template <class... Kinds>
Commands make_commands() {
  Commands commands;
  (commands.push_back(std::make_unique<Kinds>()), ...);
  return commands;
}

// What the user asked for: a text, the version or a command.
struct Request {
  std::string help;            // to be printed on stdout; empty: no help
  bool version = false;        // --version
  bool json = false;           // --json
  Command* command = nullptr;  // one of those given, with its options read; null: help or version
};

// Reads the words after the program's name. Throws InputError: unknown command, option or format with the nearest known one, a missing
// argument, a number that is none. A command is good for one call: its options keep what they were given.
Request parse_command_line(const Commands& commands, const std::vector<std::string>& words);

// Runs the command that `words`, those after the program's name, ask for and returns the exit status: 0 good, 1 a check failed,
// 2 bad input, 130 interrupted. Whatever goes wrong is one message on stderr.
int run_program(const Commands& commands, const std::vector<std::string>& words);

}  // namespace slipbench
