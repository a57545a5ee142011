// Text output of an evaluation and of an exploration of costs.
#pragma once

#include <cstddef>
#include <string>

#include "tools/cli/terminal.h"
#include "tools/cost/explore.h"
#include "tools/dataset/record/json.h"

namespace slipbench {

// `result`: of eval::evaluate(). The least misleading figures come first.
std::string eval_text(const Json& result, const Style& style);

// The sentences, a table of all settings by series with their worst errors, the reasons of settings
// that did not run, the price of each effect.
std::string cost_text(const cost::Exploration& exploration, const Style& style, std::size_t width);

}  // namespace slipbench
