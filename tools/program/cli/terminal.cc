#include "tools/program/cli/terminal.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/cli/command.h"

namespace slipbench {
namespace {

constexpr std::size_t default_width = 100;

std::string escape(bool colour, std::string_view code, std::string_view text) {
  return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
}

}  // namespace

std::string Style::bold(std::string_view text) const { return escape(colour_, "1", text); }
std::string Style::dim(std::string_view text) const { return escape(colour_, "2", text); }
std::string Style::good(std::string_view text) const { return escape(colour_, "32", text); }
std::string Style::error(std::string_view text) const { return escape(colour_, "1;31", text); }
std::string Style::heading(std::string_view text) const { return escape(colour_, "1;36", text); }

bool is_interactive(std::FILE* stream) {
  const char* term = std::getenv("TERM");
  return isatty(fileno(stream)) == 1 && (term == nullptr || std::string_view(term) != "dumb");
}

Style style_for(std::FILE* stream) {
  const char* no_color = std::getenv("NO_COLOR");
  return Style(is_interactive(stream) && (no_color == nullptr || *no_color == '\0'));
}

void say(std::FILE* stream, const std::string& text) noexcept {
  std::fputs(text.c_str(), stream);
  std::fflush(stream);
}

std::size_t terminal_width(std::FILE* stream) {
  winsize size{};
  const bool known = isatty(fileno(stream)) == 1 && ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : default_width;
}

std::string wrap_text(std::string_view text, std::size_t width, std::size_t indent) {
  const std::string margin(indent, ' ');
  std::string result;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    std::size_t column = indent;
    bool first = true;  // on its line
    result += margin;
    for (std::size_t begin = 0; begin <= line.size();) {
      const std::size_t end = std::min(line.find(' ', begin), line.size());
      const std::string_view word = line.substr(begin, end - begin);
      if (!first && column + 1 + word.size() > width) {
        result += '\n' + margin;
        column = indent;
      } else if (!first) {
        result += ' ';
        ++column;
      }
      result += word;
      column += word.size();
      first = false;
      begin = end + 1;
    }
    result += '\n';
  }
  return result;
}

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

std::string suggestion(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(word, candidates);
  return nearest.empty() ? ";" : fmt::format("; did you mean '{}'?", nearest);
}

namespace {
int stdout_aside = -1;
}

void set_stdout_aside() {
  stdout_aside = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (stdout_aside >= 0) dup2(STDERR_FILENO, STDOUT_FILENO);
}

void take_stdout_back() {
  if (stdout_aside < 0) return;
  std::fflush(stdout);
  dup2(stdout_aside, STDOUT_FILENO);
  close(std::exchange(stdout_aside, -1));
}

int print_json(const Json& result) {
  take_stdout_back();
  fmt::print("{}\n", result.dump(-1, ' ', false, Json::error_handler_t::replace));
  return exit_good;
}

}  // namespace slipbench
