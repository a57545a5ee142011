// The page of `slipbench cost`: what accuracy costs, what each effect costs, and how long a step stays stable.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/page.h"

namespace slipbench::cost {

// The files of web/, in the order in which the page loads them. Written by slipbench_embed().
const std::vector<page::Asset>& assets();

// One HTML page that needs no other file, of an exploration (its first key "slipbench_cost": 1; a stability map may stand in it as
// "stability") or of a stability map alone ("slipbench_stability": 1). Text of `result` is shown as text, never as markup. Throws
// std::logic_error where `result` begins with neither key.
std::string cost_page(const Json& result);

// The page, and either of the objects beside it.
inline constexpr page::PageKind page_kind{"an exploration",
                                          "slipbench cost",
                                          "page of slipbench cost",
                                          "result of slipbench cost",
                                          {"slipbench_cost", "slipbench_stability"}};

}  // namespace slipbench::cost
