// Text output of `check`.
#pragma once

#include <string>

#include "tools/check/check.h"
#include "tools/cli/terminal.h"

namespace slipbench {

// A table with one row per expectation, the detectors' scores, and for each failed expectation the
// reason and the command that repeats its worst trial.
std::string check_text(const SceneCheck& check, const Style& style);

}  // namespace slipbench
