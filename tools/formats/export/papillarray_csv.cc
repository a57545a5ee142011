#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/core/math.h"
#include "tools/files/reject.h"
#include "tools/formats/export/formats.h"
#include "tools/learning_data/vendor_states.h"

namespace slipbench {
namespace {

// Total force of all pillars, and its torque about the deformed tip of the centre pillar [N, N mm].
std::array<double, 6> global_load(const PapillarraySamples& samples, std::size_t row) {
  const auto deformed_tip = [&](std::size_t pillar) {
    std::array<double, 3> tip = samples.tip(pillar);
    const std::array<float, 3> displacement = samples.displacement(row, pillar);
    for (std::size_t axis = 0; axis < 3; ++axis) tip[axis] += displacement[axis];
    return tip;
  };
  const std::array<double, 3> reference = deformed_tip(middle_pillar);
  std::array<double, 6> load{};
  for (std::size_t p = 0; p < pillars; ++p) {
    const std::array<float, 3> force = samples.force(row, p);
    std::array<double, 3> arm = deformed_tip(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      arm[axis] = 1e3 * (arm[axis] - reference[axis]);
      load[axis] += force[axis];
    }
    load[3] += arm[1] * force[2] - arm[2] * force[1];
    load[4] += arm[2] * force[0] - arm[0] * force[2];
    load[5] += arm[0] * force[1] - arm[1] * force[0];
  }
  return load;
}

// `states`: vendor_states() of the samples.
void append_sensor(fmt::memory_buffer& text, const PapillarraySamples& samples, std::size_t row,
                   const std::vector<VendorState>& states) {
  auto out = std::back_inserter(text);
  for (std::size_t p = 0; p < pillars; ++p) {
    for (const float metres : samples.displacement(row, p)) fmt::format_to(out, ",{}", millimetres(metres));
    for (const float newtons : samples.force(row, p)) fmt::format_to(out, ",{}", newtons);
  }
  for (const double value : global_load(samples, row)) fmt::format_to(out, ",{}", static_cast<float>(value));
  fmt::format_to(out, ",1,{}", is_loaded(samples, row, middle_pillar) ? 1 : 0);
  for (std::size_t p = 0; p < pillars; ++p) {
    fmt::format_to(out, ",{},{}", samples.force(row, p)[2] >= vendor_contact_force ? 1 : 0,
                   static_cast<int>(states[row * pillars + p]));
  }
  fmt::format_to(out, ",-1");  // -1: none; the device's own friction estimate is not simulated
}

constexpr double training_rate = 1000.0;  // Hz, which the training code assumes

// Slower speeds [m/s] are float32 rounding.
constexpr double at_rest = 1e-6;

// A "stop" trial of the published protocol brakes 50 to 100 ms after its start [s].
constexpr double longest_stop = 0.1;

struct Move {
  double duration = 0.0;  // s, time for which the pad moves in the plane at more than half of its top pace
  bool braked = false;    // true if it is slower than that at the end of the recording
};

// The limit is the same for speeding up and braking, so the duration is the time from the start of
// the motion to the start of the braking, whatever the limit.
Move move_of(const BodyRecord& pad, const std::vector<double>& time) {
  std::vector<double> pace;  // m/s, of the centre and of a corner about it
  for (std::size_t row = 0; row < time.size(); ++row) {
    const float* velocity = pad.velocity.data() + 6 * row;
    pace.push_back(math::hypot(velocity[0], velocity[1]) + corner_radius * std::abs(velocity[5]));
  }
  const double top = pace.empty() ? 0.0 : *std::max_element(pace.begin(), pace.end());
  if (top < at_rest) return {};
  Move move;
  for (std::size_t row = 1; row < time.size(); ++row) move.duration += pace[row] > 0.5 * top ? time[row] - time[row - 1] : 0.0;
  move.braked = pace.back() <= 0.5 * top;
  return move;
}

// In mm/s with all digits and at least one decimal, without an exponent, whose "-" would split the
// name: "0.5", "4.0", "1.25".
std::string speed_text(double speed) {
  std::string text = fmt::format("{:.9f}", 1e3 * speed);
  while (text.ends_with('0') && !text.ends_with(".0")) text.pop_back();
  return text;
}

}  // namespace

std::string millimetres(float metres) {
  const double exact = 1e3 * static_cast<double>(metres);
  // Digits of the nearest float32 in mm. In places float32 is denser in m than in mm, so that they
  // may read back as a neighbour.
  std::string text = fmt::format("{}", static_cast<float>(exact));
  double back = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), back);
  return static_cast<float>(back / 1e3) == metres ? text : fmt::format("{:.9g}", exact);
}

bool begins_as_vendor_csv(std::string_view text) { return text.starts_with("T_us,S0_P0_DX,"); }

std::string vendor_csv(const std::vector<PapillarraySamples>& sensors) {
  if (sensors.size() > 2) reject("the vendor's log contains up to 2 sensors, found {}", sensors.size());
  std::vector<std::vector<VendorState>> states;
  for (const PapillarraySamples& samples : sensors) states.push_back(vendor_states(samples));
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{}\n", fmt::join(vendor_log_columns(sensors.size()), ","));
  for (std::size_t row = 0; row < sensors[0].size(); ++row) {
    fmt::format_to(std::back_inserter(text), "{}", std::llround(1e6 * sensors[0].time(row)));
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      if (sensors[s].size() != sensors[0].size() || sensors[s].time(row) != sensors[0].time(row)) {
        throw InputError(
            "the vendor's log has one time for all sensors, but the sensors of this trial are sampled at different times");
      }
      append_sensor(text, sensors[s], row, states[s]);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

bool begins_as_training_csv(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  return std::count(line.begin(), line.end(), ',') == 72 &&
         line.find_first_not_of("0123456789+-.,einfa") == std::string_view::npos;
}

std::string training_csv(const PapillarraySamples& samples, double rate) {
  if (rate != training_rate) {
    reject("training-csv is sampled at {} Hz, but the sensor at {} Hz; run the scene with the rate of training-csv",
           training_rate, rate);
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
  // Each end may add one sample to the count.
  const double tolerance = time.size() < 2 ? 0.0 : 2.0 * (time[1] - time[0]);
  const char* end = move.braked && move.duration <= longest_stop + tolerance ? "stop" : "slip";
  if (slides) {
    return fmt::format("{}/demo_{}-v_{}-{}.csv", turns ? "combined" : "translation", trial, speed_text(motion.speed), end);
  }
  return fmt::format("rotation/demo_{}-v_{:.1f}-{}.csv", trial, 1e3 * corner_radius * std::abs(motion.rotation), end);
}

}  // namespace slipbench
