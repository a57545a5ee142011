#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/program/export/papillarray_csv.h"

namespace slipbench {
namespace {

constexpr double training_rate = 1000.0;  // Hz, which the training code takes for granted

// What is slower is the rounding of float32 [m/s].
constexpr double at_rest = 1e-6;

// A "stop" trial of the published protocol brakes 50 to 100 ms after its start [s].
constexpr double longest_stop = 0.1;

struct Move {
  double duration = 0.0;  // s, for how long the pad moves in the plane at more than half of its top pace
  bool braked = false;    // whether it is slower than that at the end of the recording
};

// With the same limit for speeding up and braking the duration is the time from the start of the motion to the start of the
// braking, whatever the limit.
Move move_of(const BodyRecord& pad, const std::vector<double>& time) {
  std::vector<double> pace;  // m/s, of the centre and of a corner about it
  for (std::size_t row = 0; row < time.size(); ++row) {
    const float* velocity = pad.velocity.data() + 6 * row;
    pace.push_back(std::hypot(velocity[0], velocity[1]) + corner_radius * std::abs(velocity[5]));
  }
  const double top = pace.empty() ? 0.0 : *std::max_element(pace.begin(), pace.end());
  if (top < at_rest) return {};
  Move move;
  for (std::size_t row = 1; row < time.size(); ++row) move.duration += pace[row] > 0.5 * top ? time[row] - time[row - 1] : 0.0;
  move.braked = pace.back() <= 0.5 * top;
  return move;
}

// In mm/s with all its digits and at least one decimal, without an exponent, whose "-" would cut the name: "0.5", "4.0", "1.25".
std::string speed_text(double speed) {
  std::string text = fmt::format("{:.9f}", 1e3 * speed);
  while (text.ends_with('0') && !text.ends_with(".0")) text.pop_back();
  return text;
}

}  // namespace

bool begins_as_training_csv(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return std::count(line.begin(), line.end(), ',') == 72 &&
         line.find_first_not_of("0123456789+-.,einfa") == std::string_view::npos;
}

std::string training_csv(const PapillarraySamples& samples, double rate) {
  if (rate != training_rate) {
    throw InputError(
        fmt::format("training-csv is sampled at {} Hz, the sensor at {} Hz; run the scene with that rate", training_rate, rate));
  }
  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  for (std::size_t row = 0; row < samples.size(); ++row) {
    fmt::format_to(out, "{}", samples.time(row));
    for (std::size_t p = 0; p < pillars; ++p) {
      fmt::format_to(out, ",{},{}", samples.touching(row, p) ? 1 : 0, samples.slipping(row, p) ? 1 : 0);
      for (const float metres : samples.displacement(row, p)) fmt::format_to(out, ",{}", millimetres(metres));
      for (const float newtons : samples.force(row, p)) fmt::format_to(out, ",{}", newtons);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

std::string training_file_name(std::size_t trial, const CommandedMotion& motion, const BodyRecord& pad,
                               const std::vector<double>& time) {
  const bool turns = motion.rotation != 0.0;
  const bool slides = motion.speed != 0.0;
  const Move move = move_of(pad, time);
  if (move.duration == 0.0 || (!turns && !slides)) return fmt::format("press/demo_{}-v_0.0-stop.csv", trial);
  // The samples at both ends may each add one to the count.
  const double tolerance = time.size() < 2 ? 0.0 : 2.0 * (time[1] - time[0]);
  const char* end = move.braked && move.duration <= longest_stop + tolerance ? "stop" : "slip";
  if (slides) {
    return fmt::format("{}/demo_{}-v_{}-{}.csv", turns ? "combined" : "translation", trial, speed_text(motion.speed), end);
  }
  return fmt::format("rotation/demo_{}-v_{:.1f}-{}.csv", trial, 1e3 * corner_radius * std::abs(motion.rotation), end);
}

}  // namespace slipbench
