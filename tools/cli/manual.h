// The manual page of the program.
#pragma once

#include <string>
#include <string_view>

#include "tools/cli/command_help.h"

namespace slipbench {

// Returns slipbench(1) in the format of man(7): every command with its options, explanation and
// examples.
std::string manual_page(const CommandHelp& program, std::string_view version);

}  // namespace slipbench
