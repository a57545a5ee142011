// The page and the tables of `slipbench eval`.
#pragma once

#include <string>
#include <vector>

#include "sim/scene/scene.h"
#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench::eval {

// Tables of the result for terminal and page.
struct Tables {
  page::TextTable figures, called;  // called: true states against the classes of their samples
  std::vector<page::TextTable> by;  // one per breakdown
};
Tables tables_of(const Json& result);

// One self-contained HTML page without scripts of a result (evaluate.h) with its `command`.
// `dataset_path`: path of the dataset, which `result` has as UTF-8 text only. `html_path`: path of the page; trials link from there to the page of `slipbench report` next to
// the dataset. Text in `result` is shown as text, never as markup. `detector`: the one of the
// result. It runs again on the worst trials, whose signals, states, probability and alarms are
// drawn from the dataset. Throws InputError if the dataset has changed since it was judged.
std::string eval_page(const Json& result, const std::string& dataset_path, const std::string& html_path,
                      const DetectorScene& detector);

}  // namespace slipbench::eval
