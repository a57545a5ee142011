// The result of `slipbench eval` as text.
#pragma once

#include <cstddef>
#include <string>

#include "tools/base/record/json.h"
#include "tools/program/cli/terminal.h"
#include "tools/program/cost/explore.h"

namespace slipbench {

// `result`: of eval::evaluate(). The figures that mislead least come first.
std::string eval_text(const Json& result, const Style& style);

// An exploration of `slipbench cost` as a person reads it on a terminal.

// The sentences, a table of all settings by series with their worst errors, why some did not run, the price of each effect.
std::string cost_text(const cost::Exploration& exploration, const Style& style, std::size_t width);

}  // namespace slipbench
