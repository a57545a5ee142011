// Terminal output: colours, widths, tables, suggestions.
#pragma once

#include <cstddef>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tools/dataset/record/json.h"
#include "tools/page/page.h"

namespace slipbench {

// Marks up text with marks that only terminal_text() reads. Every function returns its text unchanged if colours are off, so that pipes and
// files get plain text.
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

// True if `stream` is a terminal and TERM is not "dumb".
bool is_interactive(std::FILE* stream);

// Colours if is_interactive() and the variable NO_COLOR is unset or empty (no-color.org).
Style style_for(std::FILE* stream);

// Returns `text` for a terminal: printable(), but with the marks of Style. Text from outside (names in
// files, messages of libraries) can thus not move the cursor, hide or reorder text, or set a title.
std::string terminal_text(std::string_view text);

// Writes `text` for the user, as terminal_text(). Errors (a closed or full stderr) are ignored, so
// that the work continues.
void say(std::FILE* stream, const std::string& text) noexcept;

// Prints the result of a command on stdout, as terminal_text(). All commands print by it, except JSON
// (print_json) and files (`-o -`).
template <class... Values>
void print_text(fmt::format_string<Values...> format, Values&&... values) {
  fmt::print("{}", terminal_text(fmt::format(format, std::forward<Values>(values)...)));
}

// Columns of the terminal behind `stream`, 100 if it is not a terminal.
std::size_t terminal_width(std::FILE* stream);

// Breaks text at spaces so that no line is longer than `width`, except for single longer words.
// Keeps the text's line ends. Every line starts with `indent` spaces and ends with '\n'.
std::string wrap_text(std::string_view text, std::size_t width, std::size_t indent);

// A table with right-aligned columns, the first one left-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> head) : rows_{std::move(head)} {}
  // The cells may come from an untrusted file.
  explicit Table(const page::TextTable& table);

  // `row` has as many cells as the head.
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  // The table's lines, indented by two spaces; the head is dim.
  [[nodiscard]] std::string text(const Style& style) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// End of the message "unknown x 'word'": "; did you mean 'name'?" if a candidate is near, else ";".
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

// With --json and `-o -` stdout holds the result alone: other output, also of third-party
// libraries, goes to stderr until take_stdout_back().
void set_stdout_aside();
void take_stdout_back();

// Prints the result of `--json`, one object on a line of stdout, after take_stdout_back(); bytes
// that are not UTF-8 are replaced. Returns exit_good.
int print_json(const Json& result);
// The text that print_json() prints, without control, invisible and direction characters.
std::string printed_json(const Json& value);

// Sets the environment variable SLIPBENCH_CALLED_AS to `argument`, the first word of the command
// line, for as_called() and for Python code that does a command's work. Does nothing if the
// variable is set, as by the launcher, or if `argument` is empty.
void keep_program_name(const std::string& argument);
// Returns a command that begins with "slipbench", with this name replaced by the one in
// SLIPBENCH_CALLED_AS.
std::string as_called(const std::string& command);

// Prints "next: COMMAND", a command to run next. `command` begins with "slipbench".
void print_next(const std::string& command);

// "written: FILE", a line a file. Prints nothing while stdout is set aside: with `-o -` the file is
// standard output.
void print_written(const std::vector<std::string>& files);

// Values of a progress line.
struct ProgressState {
  std::size_t done = 0;               // trials finished
  std::size_t total = 0;              // trials in all
  std::optional<double> sim_seconds;  // s, simulated so far; empty: no simulation
  double elapsed = 0.0;               // s, wall-clock time
};

// "1.2k", "31k", "4.0M": at most four characters for numbers below 1e9.
std::string short_count(double value);

// A duration as text: "8 s", "2:05", "1:02:05".
std::string clock_text(double seconds);

// "[#####-----]  50 % 100/200  3.1k x real time  24 trials/s  ETA 4 s", at most `width`
// columns; the bar shrinks first.
std::string progress_bar_text(const ProgressState& state, std::size_t width);

// "100/200 trials (50 %), 3.1k x real time, 24 trials/s, ETA 4 s"
std::string progress_line_text(const ProgressState& state);

// If it lives longer than 10 s, prints once on stderr that the trials are still being prepared. A
// process that forks has no waiting thread, so it uses SIGALRM.
class PreparationNotice {
 public:
  explicit PreparationNotice(bool quiet);
  ~PreparationNotice();
  PreparationNotice(const PreparationNotice&) = delete;
  PreparationNotice& operator=(const PreparationNotice&) = delete;
};

// Draws the progress of one sweep. The destructor removes an unfinished bar, so that later output
// starts on an empty line. Not thread-safe: the sweep calls it from one thread at a time.
class Progress {
 public:
  enum class Mode {
    off,    // draws nothing
    lines,  // a line every `line_period` seconds
    bar,    // one line, redrawn
  };

  static constexpr double bar_period = 0.1;   // s, between redraws
  static constexpr double line_period = 5.0;  // s, between lines

  // `clock` gives seconds from any origin. The stream must outlive the object.
  Progress(Mode mode, std::FILE* stream, std::function<double()> clock);
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // Bar on a terminal, lines otherwise, nothing if `quiet`; uses the monotonic clock.
  static Progress for_stream(std::FILE* stream, bool quiet);

  // Reports `done` of `total` trials and the simulated time so far. Draws once the period has
  // passed, and always at the end. Draws nothing for a sweep of one trial.
  void update(std::size_t done, std::size_t total, std::optional<double> sim_seconds);
  // Progress of a run of one trial, 0 to 1. Draws once the trial has taken `line_period`.
  void part(double share);
  // Removes an unfinished bar, so that the following text starts on an empty line.
  void clear();

 private:
  Mode mode_;
  std::FILE* stream_;
  std::function<double()> clock_;
  double start_;
  double last_drawn_;
  bool on_screen_ = false;
};

}  // namespace slipbench
