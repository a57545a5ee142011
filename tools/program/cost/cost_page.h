// The page of `slipbench cost`: what accuracy costs, what each effect costs, and how long a step stays stable.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/page/json.h"

namespace slipbench::cost {

// One HTML page that needs no other file, of an exploration (its first key "slipbench_cost": 1; a stability map may stand in it as
// "stability") or of a stability map alone ("slipbench_stability": 1). Text of `result` is shown as text, never as markup. Throws
// std::logic_error where `result` begins with neither key.
std::string cost_page(const Json& result);

// Whether a file that begins so is such a page, or such an object written by write_cost().
bool begins_as_cost_page(std::string_view text);
bool begins_as_cost_json(std::string_view text);

// Writes FILE.html, and `result` beside it as FILE.json, each under a temporary name that is then renamed; returns both names. Files
// of these kinds are replaced, others are not. Throws InputError when `html_path` does not end in .html or cannot be written.
std::vector<std::string> write_cost(const std::string& html_path, const Json& result);

// The same refusals before any work is done.
void check_cost_target(const std::string& html_path);

}  // namespace slipbench::cost
