// The page and the table of `slipbench detect`.
#pragma once

#include <cstddef>
#include <string>

#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench::eval {

// One row per trial, the worst first; at most `most` rows.
page::TextTable detections_table(const Json& result, std::size_t most);

// One HTML page without scripts: signals, probability and alarms of the worst trials, then a table
// of all trials. Reads the signals from the recordings that `result` names.
std::string detect_page(const Json& result);

}  // namespace slipbench::eval
