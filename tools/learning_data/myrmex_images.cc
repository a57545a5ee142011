#include "tools/learning_data/myrmex_images.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "sensors/myrmex/foam_cell.h"
#include "tools/files/reject.h"

namespace slipbench {
namespace {

using myrmex::full_scale;

// Sine and cosine of `turn` times 30 degrees; exact for quarter turns.
std::pair<double, double> sine_cosine(std::size_t turn) {
  constexpr double half = 0.5, most = 0.5 * std::numbers::sqrt3;
  constexpr std::array<double, rotations> sines{0.0, half, most, 1.0, most, half, 0.0, -half, -most, -1.0, -most, -half};
  return {sines[turn % rotations], sines[(turn + 3) % rotations]};
}

bool is_array(const SensorRecord& sensor) {
  return sensor.type == "myrmex" && sensor.channels.size() == 1 && sensor.channels[0].shape.size() == 2;
}

}  // namespace

std::string myrmex_csv(const SensorRecord& sensor) {
  if (!is_array(sensor)) reject("sensor {} is a {}, but a myrmex is needed", sensor.name, sensor.type);
  const SensorColumn& taxels = sensor.channels.front();
  const std::size_t rows = taxels.shape[0], columns = taxels.shape[1];
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (std::size_t first = 0; first < taxels.values.size(); first += rows * columns) {
    for (std::size_t k = 0; k < rows * columns; ++k) {
      const double counts = std::nearbyint(taxels.values[first + k % rows * columns + k / rows]);
      if (!(counts >= 0.0 && counts <= full_scale)) {
        reject("sensor {}: {} counts in sample {}; allowed: 0 to 4095 (electronics: quantisation)", sensor.name, counts,
               first / (rows * columns));
      }
      if (k > 0) text.push_back(',');
      fmt::format_to(out, "{}", static_cast<int>(counts));
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

bool begins_as_myrmex_csv(std::string_view text) {
  std::string_view line = text.substr(0, text.find('\n'));
  // A single number is no evidence: any file may begin with one.
  if (line.find(',') == std::string_view::npos) return false;
  while (!line.empty()) {
    const std::string_view number = line.substr(0, line.find(','));
    const bool digits = std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; });
    if (number.empty() || number.size() > 4 || !digits) return false;
    int counts = 0;
    std::from_chars(number.data(), number.data() + number.size(), counts);
    if (counts > full_scale) return false;
    if (number.size() == line.size()) break;
    line.remove_prefix(number.size() + 1);
  }
  return true;
}

void turn_image(std::span<const float> image, std::size_t rows, std::size_t columns, std::size_t turn,
                std::span<float, cropped * cropped> out) {
  const auto [sine, cosine] = sine_cosine(turn);
  const double middle = 0.5 * (cropped - 1.0), middle_row = 0.5 * (static_cast<double>(rows) - 1.0),
               middle_column = 0.5 * (static_cast<double>(columns) - 1.0);
  const auto clamped = [](double place, std::size_t count) { return std::clamp(place, 0.0, static_cast<double>(count - 1)); };
  for (std::size_t r = 0; r < cropped; ++r) {
    for (std::size_t c = 0; c < cropped; ++c) {
      // X to the right, Y up. The value comes from the position before the turn.
      const double x = static_cast<double>(c) - middle, y = middle - static_cast<double>(r);
      const double column = clamped(middle_column + cosine * x + sine * y, columns);
      const double row = clamped(middle_row - (cosine * y - sine * x), rows);
      const auto left = std::min(static_cast<std::size_t>(column), columns - 2),
                 above = std::min(static_cast<std::size_t>(row), rows - 2);
      const double to_right = column - static_cast<double>(left), down = row - static_cast<double>(above);
      const auto at = [&](std::size_t i, std::size_t j) { return static_cast<double>(image[i * columns + j]); };
      const double upper = (1.0 - to_right) * at(above, left) + to_right * at(above, left + 1);
      const double lower = (1.0 - to_right) * at(above + 1, left) + to_right * at(above + 1, left + 1);
      out[r * cropped + c] = static_cast<float>((1.0 - down) * upper + down * lower);
    }
  }
}

TrialRecord turned_images(TrialRecord record) {
  bool found = false;
  for (SensorRecord& sensor : record.sensors) {
    if (!is_array(sensor)) continue;
    SensorColumn& taxels = sensor.channels.front();
    const std::size_t rows = taxels.shape[0], columns = taxels.shape[1];
    if (rows < cropped || columns < cropped) continue;
    found = true;
    constexpr std::size_t image = cropped * cropped;
    const std::size_t samples = taxels.values.size() / (rows * columns);
    std::vector<float> turned(samples * rotations * image);
    for (std::size_t k = 0; k < samples; ++k) {
      const auto seen = std::span<const float>(taxels.values).subspan(k * rows * columns, rows * columns);
      for (std::size_t turn = 0; turn < rotations; ++turn) {
        turn_image(seen, rows, columns, turn, std::span(turned).subspan((k * rotations + turn) * image).first<image>());
      }
    }
    taxels.values = std::move(turned);
    taxels.shape = {rotations, cropped, cropped};
    sensor.channel_names.clear();
  }
  if (!found) reject("trial {}: no myrmex of 12 x 12 taxels or more", record.trial);
  return record;
}

}  // namespace slipbench
