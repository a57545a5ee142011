// The board as a page and as a table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/base/page/json.h"

namespace slipbench::benchmark {

// One HTML page without scripts of a board (benchmark.h).
std::string board_page(const Json& result);

// Whether a file that begins so is such a page, or such a board.
bool begins_as_board_page(std::string_view text);
bool begins_as_board_json(std::string_view text);

// Throws InputError when `html_path` does not end in .html, or it or FILE.json beside it cannot be written or holds something else.
void check_board_target(const std::string& html_path);
// Writes FILE.html, and `result` beside it as FILE.json; returns both names. Throws as check_board_target().
std::vector<std::string> write_board(const std::string& html_path, const Json& result);

// The columns of one set's table, "score" among them, and its rows in order.
struct BoardTable {
  std::string title;  // "open recordings, papillarray: 96 trials"
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> left_out;  // "gst_hd: why"
};
BoardTable board_table(const Json& set);

}  // namespace slipbench::benchmark
