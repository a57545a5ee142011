// The board as a page and as a table.
#pragma once

#include <string>
#include <vector>

#include "tools/base/page/page.h"
#include "tools/program/benchmark/benchmark.h"

namespace slipbench::benchmark {

// One HTML page without scripts of a board (benchmark.h).
std::string board_page(const Json& result);

// The page and the board as they are written.
inline constexpr page::PageKind page_kind{
    "a board", "slipbench benchmark", "page of slipbench benchmark", "board of slipbench benchmark", {result_key}};

// The columns of one set's table, "score" among them, and its rows in order.
struct BoardTable {
  std::string title;  // "open recordings, papillarray: 96 trials"
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> left_out;  // "gst_hd: why"
};
BoardTable board_table(const Json& set);

}  // namespace slipbench::benchmark
