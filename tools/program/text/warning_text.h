// Warnings on the terminal.
#pragma once

#include <vector>

#include "tools/program/sweep/warnings.h"

namespace slipbench {

// A line each on stderr, also where there is no progress and no summary: "slipbench: warning: stage.yaml:14: motion.start ...".
void print_warnings(const std::vector<Warning>& warnings);

}  // namespace slipbench
