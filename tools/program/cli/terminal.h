// What a person at a terminal reads: colours, widths, tables, suggestions.
#pragma once

#include <cstddef>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/page/page.h"
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

// A table with right-aligned columns, the first one left-aligned.
class Table {
 public:
  explicit Table(std::vector<std::string> head) : rows_{std::move(head)} {}
  // Its cells may come from a file.
  explicit Table(const page::TextTable& table);

  // `row` has as many cells as the head.
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  // Its lines, indented by two spaces; the head is dim.
  [[nodiscard]] std::string text(const Style& style) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

// What follows "unknown x 'word'" in a message: "; did you mean 'name'?" when a candidate is near, else ";".
std::string suggestion(const std::string& word, const std::vector<std::string>& candidates);

// With --json the object alone stands on stdout: what a library of somebody else prints there goes to stderr, until stdout is taken back.
void set_stdout_aside();
void take_stdout_back();

// The result of `--json`: an object on a line of stdout, which is taken back; bytes that are no UTF-8 are replaced. Returns exit_good.
int print_json(const Json& result);

// "written: FILE", a line a file.
void print_written(const std::vector<std::string>& files);

// What a progress line is made of.
struct ProgressState {
  std::size_t done = 0;               // trials finished
  std::size_t total = 0;              // trials asked for
  std::optional<double> sim_seconds;  // s, simulated so far; empty where nothing is simulated
  double elapsed = 0.0;               // s, passed on the clock
};

// "1.2k", "31k", "4.0M": at most four characters for numbers below 1e9.
std::string short_count(double value);

// A span of time as a person says it: "8 s", "2:05", "1:02:05".
std::string clock_text(double seconds);

// "[#####-----]  50 % 100/200  3.1k x real time  24 trials/s  ETA 4 s", no longer than `width` columns: the bar gives way first.
std::string progress_bar_text(const ProgressState& state, std::size_t width);

// "100/200 trials (50 %), 3.1k x real time, 24 trials/s, ETA 4 s"
std::string progress_line_text(const ProgressState& state);

// As long as it lives, and that is 10 s, says on stderr, once, that the trials are still being prepared: a process that forks has no thread to wait in,
// so it takes SIGALRM.
class PreparationNotice {
 public:
  explicit PreparationNotice(bool quiet);
  ~PreparationNotice();
  PreparationNotice(const PreparationNotice&) = delete;
  PreparationNotice& operator=(const PreparationNotice&) = delete;
};

// Draws the progress of one sweep; an unfinished bar goes with the object, so that what follows, a message too, starts on an empty line. Not thread-safe: the sweep calls it from one thread at a time.
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
  // Bar on a terminal, lines otherwise, nothing when `quiet`; the clock is the machine's monotonic one.
  static Progress for_stream(std::FILE* stream, bool quiet);

  // Reports `done` of `total` trials and what has been simulated so far. Draws when the time has come, and always at the end.
  // A sweep of one trial has no progress to show: nothing is drawn.
  void update(std::size_t done, std::size_t total, std::optional<double> sim_seconds);
  // Of a run of one trial: how much of it is done. Draws once it has taken `line_period`.
  void part(double share);
  // Removes an unfinished bar, so that the text which follows starts on an empty line.
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
