#include "tools/cli/commands/help_commands.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/cli/arguments.h"
#include "tools/cli/completion.h"
#include "tools/cli/manual.h"
#include "tools/cli/terminal.h"
#include "tools/doctor/doctor.h"
#include "tools/files/reject.h"

namespace slipbench {

int TableTextCommand::run() {
  if (json) return print_json({{"text", text_}});
  fmt::print("{}", text_);
  return exit_good;
}

void HelpCommand::declare(Arguments& arguments) {
  arguments.about("help", "Explain a command", R"(
Prints the same text as --help.

Examples:
  slipbench help
  slipbench help run
  slipbench help hd replay)");
  arguments.texts("COMMAND", path, "Command to explain (default: the program)").offers([&arguments] {
    return arguments.command_names();
  });
  arguments.then([this, &arguments] { text_ = arguments.help_of(path); });
}

void CompletionCommand::declare(Arguments& arguments) {
  arguments.about("completion", "Print a completion script for a shell", R"(
The script completes commands, options, values and file names.

Examples:
  slipbench completion bash > slipbench.bash
  slipbench completion zsh > _slipbench
  slipbench completion fish > slipbench.fish

bash: add `. slipbench.bash` to ~/.bashrc. zsh: move _slipbench to a folder of $fpath.
fish: move slipbench.fish to ~/.config/fish/completions.)");
  const auto shells = [] { return std::vector<std::string>{completion_shells.begin(), completion_shells.end()}; };
  arguments.text("SHELL", shell, fmt::format("{}", fmt::join(completion_shells, ", "))).required().offers(shells);
  arguments.then([this, &arguments] {
    if (std::ranges::find(completion_shells, shell) == completion_shells.end())
      reject("completion: unknown shell {}{}", quote(shell), allowed_names(shell, completion_shells));
    text_ = completion_script(arguments.table(), shell);
  });
}

void ManCommand::declare(Arguments& arguments) {
  arguments.about("man", "Print the manual page", R"(
The page has all commands with their options and examples, in the format of man(7).

Examples:
  slipbench man > slipbench.1

Show it with: man -l slipbench.1)");
  arguments.then([this, &arguments] { text_ = manual_page(arguments.table(), build_info().version); });
}

}  // namespace slipbench
