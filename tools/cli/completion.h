// Scripts by which a shell completes the words of the command line.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "tools/cli/command_help.h"

namespace slipbench {

inline constexpr std::array<std::string_view, 3> completion_shells{"bash", "fish", "zsh"};

// Returns the script for a shell of `completion_shells`: commands, options, their values and file
// arguments. The script contains the whole table, so a shell completes without starting the
// program.
std::string completion_script(const CommandHelp& program, std::string_view shell);

}  // namespace slipbench
