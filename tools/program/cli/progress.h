// How far a sweep is: a bar on a terminal, plain lines elsewhere.
#pragma once

#include <cstddef>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>

namespace slipbench {

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
