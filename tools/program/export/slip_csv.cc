#include "tools/program/export/slip_csv.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"
#include "tools/program/samples/commanded_motion.h"

namespace slipbench {
namespace {

constexpr std::size_t slip_csv_electrodes = 24;
constexpr double slip_csv_rate = 100.0;  // Hz
constexpr std::string_view slip_csv_beginning = "ff_e1,ff_e2,";

std::string class_of(const DatasetReader& reader, std::size_t trial) {
  const auto value = [&](const char* name) { return commanded_number(reader, trial, name).value_or(0.0); };
  const double speed = value("speed"), rotation = value("rotation"), direction = value("direction");
  if (speed > 0.0 && rotation != 0.0) {
    throw InputError(fmt::format("trial {}: slides and turns; allowed: one of both, which is its class", trial));
  }
  if (rotation != 0.0) return rotation > 0.0 ? "cw" : "aw";
  if (!(speed > 0.0)) return "t";
  const double quarters = direction / (0.5 * std::numbers::pi), whole = std::round(quarters);
  if (std::abs(quarters - whole) > 1e-6) {
    throw InputError(
        fmt::format("trial {}: motion.direction is {}; allowed: 0, 90, 180 and 270 deg, which are classes n, e, s, w", trial,
                    format_quantity(direction, Quantity::angle)));
  }
  const double turn = whole - 4.0 * std::floor(whole / 4.0);
  return std::string(1, "nesw"[static_cast<std::size_t>(turn)]);
}

std::string object_of(const DatasetReader& reader, std::size_t trial) {
  const std::string material = commanded_word(reader, trial, "surface.material"),
                    shape = commanded_word(reader, trial, "surface.shape");
  const std::string name = material.empty() ? "surface" : material;
  return shape.empty() || shape == "plane" ? name : name + '_' + shape;
}

}  // namespace

SlipRecording slip_csv(const DatasetReader& reader, std::size_t trial, const std::string& sensor) {
  const SensorRecord record = reader.read_sensor(trial, sensor);
  const auto electrodes = std::ranges::find(record.channels, "electrodes", &SensorColumn::name);
  if (record.type != "biotac_sp" || electrodes == record.channels.end() ||
      electrodes->shape != std::vector<std::size_t>{slip_csv_electrodes}) {
    throw InputError(
        fmt::format("trial {}: sensor '{}' is a {}; allowed: a biotac_sp, which slip-csv is for", trial, sensor, record.type));
  }
  if (record.rate != slip_csv_rate) {
    throw InputError(fmt::format("trial {}: sensor '{}' has {}; allowed: 100 Hz, the rate of slip-csv", trial, sensor,
                                 format_quantity(record.rate, Quantity::frequency)));
  }
  double begin = 0.0;
  if (commanded_word(reader, trial, "motion.kind") == "rub") {
    begin = commanded_number(reader, trial, "start").value() + 2.0 * commanded_number(reader, trial, "approach").value();
  }

  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  for (std::size_t e = 1; e <= slip_csv_electrodes; ++e) fmt::format_to(out, "{}ff_e{}", e == 1 ? "" : ",", e);
  text.push_back('\n');
  for (std::size_t row = 0; row < record.time.size(); ++row) {
    if (record.time[row] < begin) continue;
    for (std::size_t e = 0; e < slip_csv_electrodes; ++e) {
      fmt::format_to(out, "{}{:.0f}", e == 0 ? "" : ",", electrodes->values[row * slip_csv_electrodes + e]);
    }
    text.push_back('\n');
  }
  return {fmt::format("{}/{}{}.csv", class_of(reader, trial), object_of(reader, trial), trial), fmt::to_string(text)};
}

bool begins_as_slip_csv(std::string_view text) { return text.starts_with(slip_csv_beginning); }

}  // namespace slipbench
