// The commands of slipbench.
#pragma once

#include "tools/cli/command.h"

namespace slipbench {

// All, in the order that the help shows them in.
Commands command_table();

}  // namespace slipbench
