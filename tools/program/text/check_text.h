// Text that `check` prints.
#pragma once

#include <string>

#include "tools/program/check/check.h"
#include "tools/program/cli/terminal.h"

namespace slipbench {

// A table with a row an expectation, how the detectors did, and for each expectation that failed why it did and the command that repeats its worst trial.
std::string check_text(const SceneCheck& check, const Style& style);

}  // namespace slipbench
