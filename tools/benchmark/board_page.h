// The page and the tables of a board.
#pragma once

#include <string>
#include <vector>

#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench::benchmark {

// Returns one HTML page without scripts.
std::string board_page(const Json& result);

// The table of one set; one of its columns is "score".
struct BoardTable {
  std::string title;  // "open recordings, papillarray: 96 trials"
  page::TextTable cells;
  std::vector<std::string> left_out;  // "gst_hd: why"; detectors of other sensors in one line
};
BoardTable board_table(const Json& set);

}  // namespace slipbench::benchmark
