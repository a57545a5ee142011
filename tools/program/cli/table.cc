#include "tools/program/cli/table.h"

#include <algorithm>

#include <fmt/format.h>

namespace slipbench {

std::string Table::text(const Style& style) const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string result;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    std::string line = fmt::format("  {:<{}}", rows_[r][0], widths[0]);
    for (std::size_t i = 1; i < rows_[r].size(); ++i) line += fmt::format("  {:>{}}", rows_[r][i], widths[i]);
    result += (r == 0 ? style.dim(line) : line) + '\n';
  }
  return result;
}

}  // namespace slipbench
