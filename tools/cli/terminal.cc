#include "tools/cli/terminal.h"

#include <fcntl.h>
#include <pthread.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>

#include <fmt/format.h>

#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "tools/cli/command.h"

namespace slipbench {
namespace {

int stdout_aside = -1;
constexpr const char* name_variable = "SLIPBENCH_CALLED_AS";
constexpr std::size_t default_width = 100;

// Returns the key that Style writes before each control sequence. It is random, so that no text from
// outside can contain it, not even one that equals the control sequence. Empty if the system has no
// random numbers; Style then marks nothing.
const std::string& style_key() {
  static const std::string key = [] {
    std::array<std::uint64_t, 2> random{};
    return ::getentropy(random.data(), sizeof random) == 0 ? fmt::format("\033<{:016x}{:016x}>", random[0], random[1])
                                                           : std::string();
  }();
  return key;
}

std::string escape(bool colour, std::string_view code, std::string_view text) {
  const std::string& key = style_key();
  return colour && !key.empty() ? fmt::format("{0}[{1}m{2}{0}[0m", key, code, printable(text, true)) : std::string(text);
}

// Writes text with control sequences.
void draw(std::FILE* stream, const std::string& text) noexcept {
  std::fputs(text.c_str(), stream);
  std::fflush(stream);
}

double monotonic_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double share(const ProgressState& state) {
  return state.total == 0 ? 0.0 : static_cast<double>(state.done) / static_cast<double>(state.total);
}

double per_second(double amount, const ProgressState& state) { return state.elapsed > 0.0 ? amount / state.elapsed : 0.0; }

// Remaining time at the speed so far.
std::string remaining_text(const ProgressState& state) {
  if (state.done == 0) return "?";
  const double left = static_cast<double>(state.total - state.done);
  return clock_text(state.elapsed * left / static_cast<double>(state.done));
}

// A finished sweep shows its duration instead of the remaining time.
std::string time_text(const ProgressState& state) {
  return state.done == state.total ? clock_text(state.elapsed) : "ETA " + remaining_text(state);
}

// "3.1k times real time", followed by `after`.
std::string speed_text(const ProgressState& state, std::string_view after) {
  return state.sim_seconds ? fmt::format("{} times real time{}", short_count(per_second(*state.sim_seconds, state)), after) : "";
}

void say_preparing(int) {
  constexpr std::string_view text = "slipbench: still preparing the trials after 10 s; the more bodies, the longer it takes\n";
  const int before = errno;
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
  errno = before;
}

}  // namespace

PreparationNotice::PreparationNotice(bool quiet) {
  struct sigaction action {};
  action.sa_handler = quiet ? SIG_IGN : &say_preparing;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGALRM, &action, nullptr);
  constexpr unsigned patience = 10;  // s
  ::alarm(patience);
}

PreparationNotice::~PreparationNotice() { ::alarm(0); }

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

std::string terminal_text(std::string_view text) {
  const std::string& key = style_key();
  std::string result;
  for (std::size_t mark = 0; !key.empty() && (mark = text.find(key)) != std::string_view::npos;) {
    result += printable(text.substr(0, mark), true);
    text.remove_prefix(mark + key.size());
    const std::size_t length = std::min(text.find('m') + 1, text.size());
    result.append("\033").append(text.substr(0, length));
    text.remove_prefix(length);
  }
  return result + printable(text, true);
}

void say(std::FILE* stream, const std::string& text) noexcept { draw(stream, terminal_text(text)); }

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
    bool first = true;  // first word of the line
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

Table::Table(const page::TextTable& table) : rows_{table.head} {
  rows_.insert(rows_.end(), table.rows.begin(), table.rows.end());
  for (std::vector<std::string>& row : rows_) {
    for (std::string& cell : row) cell = printable(cell);
  }
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

void set_stdout_aside() {
  stdout_aside = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (stdout_aside < 0) return;
  dup2(STDERR_FILENO, STDOUT_FILENO);
  // User code in a forked worker may write to any descriptor.
  pthread_atfork(nullptr, nullptr, [] { close(stdout_aside); });
}

void take_stdout_back() {
  if (stdout_aside < 0) return;
  std::fflush(stdout);
  dup2(stdout_aside, STDOUT_FILENO);
  close(std::exchange(stdout_aside, -1));
}

std::string printed_json(const Json& value) {
  // Escapes all that is not ASCII if a text contains characters that a terminal must not get.
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (printable(text) == text) return text;
  return value.dump(-1, ' ', true, Json::error_handler_t::replace);
}

int print_json(const Json& result) {
  take_stdout_back();
  fmt::print("{}\n", printed_json(result));
  return exit_good;
}

void keep_program_name(const std::string& argument) {
  constexpr int keep = 0;  // what is set
  if (!argument.empty()) ::setenv(name_variable, argument.c_str(), keep);
}

std::string as_called(const std::string& command) {
  constexpr std::string_view name = "slipbench";
  const char* const called = std::getenv(name_variable);
  return called == nullptr || !command.starts_with(name) ? command : called + command.substr(name.size());
}

void print_next(const std::string& command) { print_text("{} {}\n", style_for(stdout).dim("next:"), as_called(command)); }

void print_written(const std::vector<std::string>& files) {
  if (stdout_aside >= 0) return;
  for (const std::string& file : files) print_text("{} {}\n", style_for(stdout).good("written:"), file);
}

std::string short_count(double value) {
  constexpr std::array<const char*, 4> suffixes{"", "k", "M", "G"};
  std::size_t power = 0;
  while (value >= 999.5 && power + 1 < suffixes.size()) {
    value /= 1000.0;
    ++power;
  }
  return value < 9.95 ? fmt::format("{:.1f}{}", value, suffixes[power]) : fmt::format("{:.0f}{}", value, suffixes[power]);
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long long>(std::lround(std::max(seconds, 0.0)));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

std::string progress_bar_text(const ProgressState& state, std::size_t width) {
  constexpr std::size_t longest_bar = 30;
  constexpr std::size_t shortest_bar = 5;
  const std::string text =
      fmt::format("{:3.0f} % {}/{}  {}{} trials/s  {}", 100.0 * share(state), state.done, state.total, speed_text(state, "  "),
                  short_count(per_second(static_cast<double>(state.done), state)), time_text(state));
  constexpr std::size_t frame = 3;  // brackets and the following space
  if (width < text.size() + frame + shortest_bar) return text.substr(0, width);
  const std::size_t length = std::min(longest_bar, width - text.size() - frame);
  const auto filled = static_cast<std::size_t>(share(state) * static_cast<double>(length));
  return fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(length - filled, '-'), text);
}

std::string progress_line_text(const ProgressState& state) {
  return fmt::format("{}/{} ({:.0f} %), {}{} trials/s, {}", state.done, counted(state.total, "trial"), 100.0 * share(state),
                     speed_text(state, ", "), short_count(per_second(static_cast<double>(state.done), state)), time_text(state));
}

Progress::Progress(Mode mode, std::FILE* stream, std::function<double()> clock)
    : mode_(mode), stream_(stream), clock_(std::move(clock)), start_(clock_()), last_drawn_(start_) {}

Progress Progress::for_stream(std::FILE* stream, bool quiet) {
  const Mode mode = quiet ? Mode::off : is_interactive(stream) ? Mode::bar : Mode::lines;
  return {mode, stream, monotonic_seconds};
}

void Progress::update(std::size_t done, std::size_t total, std::optional<double> sim_seconds) {
  if (mode_ == Mode::off || total < 2) return;  // a single trial shows no progress
  const double now = clock_();
  const bool finished = done == total;
  const bool due = now - last_drawn_ >= (mode_ == Mode::bar ? bar_period : line_period);
  if (!due && !finished) return;
  const ProgressState state{done, total, sim_seconds, now - start_};
  if (mode_ == Mode::bar) {
    // One column stays free: some terminals wrap when the last column is written.
    draw(stream_, "\r\033[K" + progress_bar_text(state, terminal_width(stream_) - 1) + (finished ? "\n" : ""));
    on_screen_ = !finished;
  } else {
    say(stream_, progress_line_text(state) + '\n');
  }
  last_drawn_ = now;
}

void Progress::part(double share) {
  const double now = clock_(), elapsed = now - start_;
  if (mode_ == Mode::off || elapsed < line_period || now - last_drawn_ < (mode_ == Mode::bar ? bar_period : line_period)) return;
  const std::string left = share > 0.0 ? clock_text(elapsed * (1.0 - share) / share) : "?";
  const std::string text = fmt::format("{:.3g} % of the trial, {}, ETA {}", 100.0 * share, clock_text(elapsed), left);
  draw(stream_, mode_ == Mode::bar ? "\r\033[K" + text : text + '\n');
  on_screen_ = mode_ == Mode::bar;
  last_drawn_ = now;
}

void Progress::clear() {
  if (!on_screen_) return;
  draw(stream_, "\r\033[K");
  on_screen_ = false;
}

}  // namespace slipbench
