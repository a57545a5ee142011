#include "tools/program/commands/help_commands.h"

#include <fmt/format.h>

#include "tools/program/cli/arguments.h"
#include "tools/program/cli/terminal.h"

namespace slipbench {

int TableTextCommand::run() {
  if (json) return print_json({{"text", text_}});
  fmt::print("{}", text_);
  return exit_good;
}

void HelpCommand::declare(Arguments& arguments) {
  arguments.about("help", "Explain a command", R"(
The same text as that of --help.

Examples:
  slipbench help
  slipbench help run
  slipbench help hd replay)");
  arguments.texts("COMMAND", path, "Command to explain (default: the program)");
  arguments.then([this, &arguments] { text_ = arguments.help_of(path); });
}

}  // namespace slipbench
