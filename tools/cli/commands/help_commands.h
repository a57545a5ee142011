// The commands that print help, completion scripts and the manual page.
#pragma once

#include <string>
#include <vector>

#include "tools/cli/command.h"

namespace slipbench {

// A command that prints a text made from the command table. The text is made while the command line
// is parsed, because the table does not exist afterwards.
class TableTextCommand : public Command {
 public:
  int run() override;
  [[nodiscard]] const std::string& text() const { return text_; }

 protected:
  std::string text_;
};

// `help` prints the same text as --help.
struct HelpCommand final : TableTextCommand {
  void declare(Arguments& arguments) override;

  std::vector<std::string> path;  // names of the command; empty: the program
};

// `completion` prints a script by which a shell completes command lines.
struct CompletionCommand final : TableTextCommand {
  void declare(Arguments& arguments) override;

  std::string shell;
};

// `man` prints the manual page.
struct ManCommand final : TableTextCommand {
  void declare(Arguments& arguments) override;
};

}  // namespace slipbench
