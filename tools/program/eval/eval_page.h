// The page of `slipbench eval`.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/page.h"
#include "tools/program/eval/evaluate.h"

namespace slipbench::eval {

// One HTML page without scripts, which needs no other file, of a result (evaluate.h) with its `command`. `html_path`: where it will stand; trials
// link from there to the page that `slipbench report` makes of the dataset beside it. Text of `result` is shown as text, never as markup.
std::string eval_page(const Json& result, const std::string& html_path);

// The page and the result as they are written.
inline constexpr page::PageKind page_kind{
    "an evaluation", "slipbench eval", "page of slipbench eval", "result of slipbench eval", {result_key}};

}  // namespace slipbench::eval
