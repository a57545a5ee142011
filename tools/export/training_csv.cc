#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "tools/export/papillarray_trial.h"

namespace slipbench {
namespace {

constexpr double training_rate = 1000.0;  // Hz, which the training code takes for granted

// A pad moves sideways or turns from here on; what is below is the rounding of float32.
constexpr double least_speed = 1e-6;          // m/s
constexpr double least_angular_speed = 1e-4;  // rad/s

// Distance of a corner pillar from the centre, at which a rotation's speed is given [m].
constexpr double corner_radius = 9.9e-3;

// Whether at some time every touching pillar slips.
bool slips_as_a_whole(const PapillarraySamples& samples) {
  for (std::size_t row = 0; row < samples.size(); ++row) {
    std::size_t touching = 0;
    std::size_t slipping = 0;
    for (std::size_t p = 0; p < pillars; ++p) {
      touching += samples.touching(row, p) ? 1 : 0;
      slipping += samples.slipping(row, p) ? 1 : 0;
    }
    if (touching > 0 && slipping == touching) return true;
  }
  return false;
}

}  // namespace

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
      for (const float metres : samples.displacement(row, p)) fmt::format_to(out, ",{}", static_cast<float>(1e3 * metres));
      for (const float newtons : samples.force(row, p)) fmt::format_to(out, ",{}", newtons);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

std::string training_file_name(std::size_t trial, const PapillarraySamples& samples, const BodyRecord& pad) {
  double speed = 0.0;
  double angular_speed = 0.0;
  for (std::size_t first = 0; first + 6 <= pad.velocity.size(); first += 6) {
    const float* velocity = pad.velocity.data() + first;
    speed = std::max<double>(speed, std::hypot(velocity[0], velocity[1]));
    angular_speed = std::max<double>(angular_speed, std::abs(velocity[5]));
  }
  const bool turns = angular_speed > least_angular_speed;
  const bool moves = speed > least_speed;
  const char* move = turns ? (moves ? "combined" : "rotation") : (moves ? "translation" : "press");
  const double nominal = turns && !moves ? angular_speed * corner_radius : speed;
  return fmt::format("{}/demo_{}-v_{:.1f}-{}.csv", move, trial, 1e3 * nominal, slips_as_a_whole(samples) ? "slip" : "stop");
}

}  // namespace slipbench
