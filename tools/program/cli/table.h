// Tables as the commands print them.
#pragma once

#include <string>
#include <vector>

#include "tools/program/cli/terminal.h"

namespace slipbench {

// A table with right-aligned columns, the first one left-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> head) : rows_{std::move(head)} {}

  // `row` has as many cells as the head.
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  // Its lines, indented by two spaces; the head is dim.
  [[nodiscard]] std::string text(const Style& style) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace slipbench
