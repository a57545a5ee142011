#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/quantity.h"
#include "tools/files/reject.h"
#include "tools/formats/export/formats.h"

namespace slipbench {
namespace {

constexpr std::string_view first_columns = "object,slipped";

const SensorColumn& electrodes_of(const TrialRecord& record, const char* finger) {
  const auto sensor = std::ranges::find(record.sensors, finger, &SensorRecord::name);
  if (sensor == record.sensors.end() || sensor->type != "biotac_sp") {
    reject("trial {}: no biotac_sp '{}'; expected a grasp with three, named ff, mf and th", record.trial, finger);
  }
  return *std::ranges::find(sensor->channels, "electrodes", &SensorColumn::name);
}

// "box_60x50x90": constant over all grasps of the same object.
std::string object_name(const std::string& shape, const std::vector<double>& size) {
  std::string name = shape.empty() ? "object" : shape;
  for (std::size_t k = 0; k < size.size(); ++k) name += fmt::format("{}{:.0f}", k == 0 ? '_' : 'x', 1e3 * size[k]);
  return name;
}

std::string row_of(const TrialRecord& record) {
  const BodyRecord& object = record.body("object");
  if (!record.outcome.hold) {
    reject("trial {}: its outcome does not contain whether the object was held; use a scene with 'hold'", record.trial);
  }
  const auto params = nlohmann::json::parse(record.params);
  std::string text =
      fmt::format("{},{}", object_name(params.value("bodies.object.shape", ""), object.size), record.outcome.hold->held ? 0 : 1);
  for (const char* finger : grasp_fingers) {
    const SensorColumn& column = electrodes_of(record, finger);
    const auto sensor = std::ranges::find(record.sensors, finger, &SensorRecord::name);
    const std::optional<std::size_t> row = latest_row(sensor->time, record.outcome.hold->from);
    if (!row) reject("trial {}: the sensor has no sample before hold.from", record.trial);
    for (std::size_t e = 0; e < finger_electrodes; ++e) text += fmt::format(",{}", column.values[finger_electrodes * *row + e]);
  }
  return text + '\n';
}

constexpr double slip_csv_rate = 100.0;  // Hz
constexpr std::string_view slip_csv_beginning = "ff_e1,ff_e2,";

std::string class_of(const DatasetReader& reader, std::size_t trial) {
  const auto value = [&](const char* name) { return commanded_number(reader, trial, name).value_or(0.0); };
  const double speed = value("speed"), rotation = value("rotation"), direction = value("direction");
  if (speed > 0.0 && rotation != 0.0)
    reject("trial {}: slides and turns; expected only one of them, since it determines the class", trial);
  if (rotation != 0.0) return rotation > 0.0 ? "cw" : "aw";
  if (!(speed > 0.0)) return "t";
  const double quarters = direction / (0.5 * std::numbers::pi), whole = std::round(quarters);
  if (std::abs(quarters - whole) > 1e-6) {
    reject("trial {}: motion.direction is {}; allowed: 0, 90, 180 and 270 deg (classes n, e, s, w)", trial,
           format_quantity(direction, Quantity::angle));
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

std::string grasp_csv(const DatasetReader& reader, const std::vector<std::size_t>& trials) {
  std::string text = fmt::format("{}\n", fmt::join(grasp_columns(), ","));
  for (const std::size_t trial : trials) text += row_of(reader.read_trial(trial));
  return text;
}

bool begins_as_grasp_csv(std::string_view text) { return text.starts_with(first_columns); }

SlipRecording slip_csv(const DatasetReader& reader, std::size_t trial, const std::string& sensor) {
  const SensorRecord record = reader.read_sensor(trial, sensor);
  const auto column = std::ranges::find(record.channels, "electrodes", &SensorColumn::name);
  if (record.type != "biotac_sp" || column == record.channels.end() ||
      column->shape != std::vector<std::size_t>{finger_electrodes}) {
    reject("trial {}: sensor '{}' is a {}, but slip-csv needs a biotac_sp", trial, sensor, record.type);
  }
  if (record.rate != slip_csv_rate) {
    reject("trial {}: sensor '{}' samples at {}, but slip-csv needs 100 Hz", trial, sensor,
           format_quantity(record.rate, Quantity::frequency));
  }
  double begin = 0.0;
  if (commanded_word(reader, trial, "motion.kind") == "rub") {
    begin = commanded_number(reader, trial, "start").value() + 2.0 * commanded_number(reader, trial, "approach").value();
  }

  fmt::memory_buffer text;
  auto out = std::back_inserter(text);
  for (std::size_t e = 1; e <= finger_electrodes; ++e) fmt::format_to(out, "{}ff_e{}", e == 1 ? "" : ",", e);
  text.push_back('\n');
  for (std::size_t row = 0; row < record.time.size(); ++row) {
    if (record.time[row] < begin) continue;
    for (std::size_t e = 0; e < finger_electrodes; ++e) {
      fmt::format_to(out, "{}{:.0f}", e == 0 ? "" : ",", column->values[row * finger_electrodes + e]);
    }
    text.push_back('\n');
  }
  return {fmt::format("{}/{}{}.csv", class_of(reader, trial), object_of(reader, trial), trial), fmt::to_string(text)};
}

bool begins_as_slip_csv(std::string_view text) { return text.starts_with(slip_csv_beginning); }

}  // namespace slipbench
