// The commands of slipbench.
#pragma once

#include "tools/program/cli/command.h"

namespace slipbench {

// All, in the order that the help shows them in.
Commands command_table();

}  // namespace slipbench
