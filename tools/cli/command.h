// Commands of the program.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/files/output_file.h"

namespace slipbench {

class Arguments;

inline constexpr int exit_good = 0;
inline constexpr int exit_check_failed = 1;
inline constexpr int exit_bad_input = 2;
inline constexpr int exit_interrupted = 130;  // 128 + SIGINT, by shell convention

// One command. Its options are members with their defaults.
class Command {
 public:
  virtual ~Command() = default;

  // Declares the command's name, help and options, which are read into members of this object: it
  // must outlive `arguments`.
  virtual void declare(Arguments& arguments) = 0;
  // Runs the command, prints the result on stdout and returns the exit status. Throws InputError
  // for bad input.
  virtual int run() = 0;

  // True if stderr shows errors alone, without progress and status lines.
  [[nodiscard]] bool silent() const { return quiet || json; }
  // Prints a status line on stderr ("slipbench: ..."), unless the command is silent.
  void print_status(const std::string& what) const;

  // Makes standard output the target of an option, as for `-o -`. Returns the path of a temporary
  // file with this ending, such as ".html", which the command writes instead.
  std::string stream(const std::string& ending);
  // True if an option writes to standard output. The command then prints its messages on stderr.
  [[nodiscard]] bool streams() const { return streamed_ != nullptr; }
  // Copies the temporary file, if the command wrote it, to standard output. Throws InputError if it
  // cannot.
  void send_stream();

  bool json = false;   // --json, an option of every command
  bool quiet = false;  // --quiet, if the command declares it

 private:
  std::shared_ptr<const ScratchFolder> streamed_;  // tests copy commands
  std::string stream_path_;
};

// Commands in the order of the help.
using Commands = std::vector<std::unique_ptr<Command>>;

// Creates one command of each kind, in this order.
template <class... Kinds>
Commands make_commands() {
  Commands commands;
  (commands.push_back(std::make_unique<Kinds>()), ...);
  return commands;
}

}  // namespace slipbench
