// The commands of slipbench.
#pragma once

#include "tools/cli/command.h"

namespace slipbench {

// Returns all commands in the order of the help.
Commands command_table();

}  // namespace slipbench
