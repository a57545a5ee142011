// The commands that explain the command line itself.
#pragma once

#include <string>
#include <vector>

#include "tools/program/cli/command.h"

namespace slipbench {

// A text that is made from the command table while the words are read, since the table ends with that.
class TableTextCommand : public Command {
 public:
  int run() override;
  [[nodiscard]] const std::string& text() const { return text_; }

 protected:
  std::string text_;
};

// `help`: what --help prints.
struct HelpCommand final : TableTextCommand {
  void declare(Arguments& arguments) override;

  std::vector<std::string> path;  // names of the command; empty: the program
};

// `completion`: a script by which a shell completes command lines.
struct CompletionCommand final : TableTextCommand {
  void declare(Arguments& arguments) override;

  std::string shell;
};

// `man`: the manual page.
struct ManCommand final : TableTextCommand {
  void declare(Arguments& arguments) override;
};

}  // namespace slipbench
