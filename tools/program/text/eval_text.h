// The result of `slipbench eval` as text.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "tools/program/cli/terminal.h"

namespace slipbench {

// `result`: of eval::evaluate(). The figures that mislead least come first.
std::string eval_text(const nlohmann::ordered_json& result, const Style& style);

}  // namespace slipbench
