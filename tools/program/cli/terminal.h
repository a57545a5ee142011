// What a person at a terminal reads: colours, widths, tables, suggestions.
#pragma once

#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/record/json.h"

namespace slipbench {

// Marks up text. Every function returns its text unchanged when colours are off, so that a pipe or a file gets plain text.
class Style {
 public:
  explicit Style(bool colour) : colour_(colour) {}

  [[nodiscard]] bool colour() const { return colour_; }
  [[nodiscard]] std::string bold(std::string_view text) const;
  [[nodiscard]] std::string dim(std::string_view text) const;
  [[nodiscard]] std::string good(std::string_view text) const;     // green
  [[nodiscard]] std::string error(std::string_view text) const;    // bold red
  [[nodiscard]] std::string heading(std::string_view text) const;  // bold cyan

 private:
  bool colour_;
};

// Whether a person watches `stream`: it is a terminal, and TERM is not "dumb".
bool is_interactive(std::FILE* stream);

// Colours only where a person watches and the variable NO_COLOR is unset or empty (no-color.org).
Style style_for(std::FILE* stream);

// Writes `text` for a person to read. Where it cannot be written (a closed or full stderr), nothing happens: the work goes on.
void say(std::FILE* stream, const std::string& text) noexcept;

// Columns of the terminal behind `stream`, 100 where there is none.
std::size_t terminal_width(std::FILE* stream);

// Text broken at spaces so that no line is longer than `width`, unless one word is. Line ends of the text are kept. Every line
// starts with `indent` spaces and ends with '\n'.
std::string wrap_text(std::string_view text, std::size_t width, std::size_t indent);

// Tables as the commands print them.

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

// Help after a word that was not understood.

// What follows "unknown x 'word'" in a message: "; did you mean 'name'?" when a candidate is near, else ";".
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

// With --json the object alone stands on stdout: what a library of somebody else prints there goes to stderr, until stdout is taken back.
void set_stdout_aside();
void take_stdout_back();

// The result of `--json`: an object on a line of stdout, which is taken back; bytes that are no UTF-8 are replaced. Returns exit_good.
int print_json(const Json& result);

}  // namespace slipbench
