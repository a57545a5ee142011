// A source's lines, one at a time, and errors that name them.
#pragma once

#include <cstddef>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/program/import/import_format.h"

namespace slipbench {

class SourceTable {
 public:
  static constexpr std::size_t longest_line = 65'536;  // bytes

  // Throws InputError where the file is no regular one or cannot be opened.
  explicit SourceTable(const SourceFile& file);

  // Goes to the next line and cuts it at its commas; false at the end. A line may end with a carriage return, the first may begin with the
  // mark of UTF-8, and a last one that is empty is none. Throws InputError for one that is too long.
  bool next();
  // Number of the current line, from 1. Its text, and its cells without blanks around them, valid until next().
  [[nodiscard]] std::size_t line() const { return line_; }
  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] std::span<const std::string_view> cells() const { return cells_; }

  // Throws InputError "FILE:LINE: what".
  [[noreturn]] void fail(const std::string& what) const;

  // Reads a header. Throws InputError unless it has these names and no more.
  void expect_header(std::span<const std::string> names);
  // Throws InputError unless the line has so many cells.
  void expect_cells(std::size_t count) const;
  // A cell as a finite number within [least, most]; `name` says what it is.
  [[nodiscard]] double number(std::size_t cell, std::string_view name, double least, double most) const;
  // The same, any that a float32 holds.
  [[nodiscard]] float value(std::size_t cell, std::string_view name) const;
  // A cell that is one of these whole numbers.
  [[nodiscard]] int one_of(std::size_t cell, std::string_view name, std::span<const int> allowed) const;
  [[nodiscard]] bool flag(std::size_t cell, std::string_view name) const;
  // Throws InputError where a recording with so many rows of so many bytes is too large.
  void expect_room(std::size_t rows, std::size_t row_bytes) const;

 private:
  bool at_end();  // whether no byte is left
  [[noreturn]] void refuse(std::size_t cell, std::string_view name, const std::string& allowed) const;

  std::string path_;
  std::ifstream stream_;
  std::vector<char> buffer_;
  std::string_view text_;
  std::vector<std::string_view> cells_;
  std::size_t line_ = 0;
};

}  // namespace slipbench
