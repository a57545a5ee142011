// The page of `slipbench eval`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/page/json.h"

namespace slipbench::eval {

// One HTML page without scripts, which needs no other file, of a result (evaluate.h) with its `command`. `html_path`: where it will stand; trials
// link from there to the page that `slipbench report` makes of the dataset beside it. Text of `result` is shown as text, never as markup.
std::string eval_page(const Json& result, const std::string& html_path);

// Whether a file that begins so is such a page, or such a result written by write_eval().
bool begins_as_eval_page(std::string_view text);
bool begins_as_eval_json(std::string_view text);

// Throws InputError when `html_path` does not end in .html, or it or FILE.json beside it cannot be written or holds something else.
void check_eval_target(const std::string& html_path);
// Writes FILE.html, and `result` beside it as FILE.json; returns both names. Throws as check_eval_target().
std::vector<std::string> write_eval(const std::string& html_path, const Json& result);

}  // namespace slipbench::eval
