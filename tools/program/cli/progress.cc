#include "tools/program/cli/progress.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <string_view>
#include <utility>

#include <unistd.h>

#include <fmt/format.h>

#include "tools/program/cli/terminal.h"

namespace slipbench {
namespace {

double monotonic_seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double share(const ProgressState& state) {
  return state.total == 0 ? 0.0 : static_cast<double>(state.done) / static_cast<double>(state.total);
}

double per_second(double amount, const ProgressState& state) { return state.elapsed > 0.0 ? amount / state.elapsed : 0.0; }

// Time left when the rest goes as fast as what is done.
std::string remaining_text(const ProgressState& state) {
  if (state.done == 0) return "?";
  const double left = static_cast<double>(state.total - state.done);
  return clock_text(state.elapsed * left / static_cast<double>(state.done));
}

// A finished sweep has no time left; what it took is of more use.
std::string time_text(const ProgressState& state) {
  return state.done == state.total ? clock_text(state.elapsed) : "ETA " + remaining_text(state);
}

// "3.1k x real time" and what stands after it.
std::string speed_text(const ProgressState& state, std::string_view after) {
  return state.sim_seconds ? fmt::format("{} x real time{}", short_count(per_second(*state.sim_seconds, state)), after) : "";
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
  constexpr std::size_t frame = 3;  // brackets and the space after them
  if (width < text.size() + frame + shortest_bar) return text.substr(0, width);
  const std::size_t length = std::min(longest_bar, width - text.size() - frame);
  const auto filled = static_cast<std::size_t>(share(state) * static_cast<double>(length));
  return fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(length - filled, '-'), text);
}

std::string progress_line_text(const ProgressState& state) {
  return fmt::format("{}/{} trials ({:.0f} %), {}{} trials/s, {}", state.done, state.total, 100.0 * share(state),
                     speed_text(state, ", "), short_count(per_second(static_cast<double>(state.done), state)), time_text(state));
}

Progress::Progress(Mode mode, std::FILE* stream, std::function<double()> clock)
    : mode_(mode), stream_(stream), clock_(std::move(clock)), start_(clock_()), last_drawn_(start_) {}

Progress Progress::for_stream(std::FILE* stream, bool quiet) {
  const Mode mode = quiet ? Mode::off : is_interactive(stream) ? Mode::bar : Mode::lines;
  return {mode, stream, monotonic_seconds};
}

void Progress::update(std::size_t done, std::size_t total, std::optional<double> sim_seconds) {
  if (mode_ == Mode::off || total < 2) return;  // one trial has no progress to show
  const double now = clock_();
  const bool finished = done == total;
  const bool due = now - last_drawn_ >= (mode_ == Mode::bar ? bar_period : line_period);
  if (!due && !finished) return;
  const ProgressState state{done, total, sim_seconds, now - start_};
  if (mode_ == Mode::bar) {
    // One column stays free: some terminals break the line when the last one is written.
    say(stream_, "\r\033[K" + progress_bar_text(state, terminal_width(stream_) - 1) + (finished ? "\n" : ""));
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
  say(stream_, mode_ == Mode::bar ? "\r\033[K" + text : text + '\n');
  on_screen_ = mode_ == Mode::bar;
  last_drawn_ = now;
}

void Progress::clear() {
  if (!on_screen_) return;
  say(stream_, "\r\033[K");
  on_screen_ = false;
}

}  // namespace slipbench
