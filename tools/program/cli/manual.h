// The manual page of the program.
#pragma once

#include <string>
#include <string_view>

#include "tools/program/cli/command_help.h"

namespace slipbench {

// The page slipbench(1) in the language of man(7): every command with its options, its explanation and its examples.
std::string manual_page(const CommandHelp& program, std::string_view version);

}  // namespace slipbench
