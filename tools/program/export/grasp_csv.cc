#include "tools/program/export/grasp_csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/program/samples/samples.h"

namespace slipbench {
namespace {

constexpr std::array<const char*, 3> fingers{"ff", "mf", "th"};
constexpr std::size_t electrodes = 24;
constexpr std::string_view first_columns = "object,slipped";

std::string header() {
  std::string text(first_columns);
  for (const char* finger : fingers) {
    for (std::size_t e = 1; e <= electrodes; ++e) text += fmt::format(",{}_biotac_{}", finger, e);
  }
  return text + '\n';
}

const BodyRecord& body_of(const TrialRecord& record, std::string_view name) {
  const auto found = std::ranges::find(record.bodies, name, &BodyRecord::name);
  if (found == record.bodies.end()) {
    throw InputError(fmt::format("trial {}: has no truth/{}", record.trial, name));
  }
  return *found;
}

const SensorColumn& electrodes_of(const TrialRecord& record, const char* finger) {
  const auto sensor = std::ranges::find(record.sensors, finger, &SensorRecord::name);
  if (sensor == record.sensors.end() || sensor->type != "biotac_sp") {
    throw InputError(
        fmt::format("trial {}: no biotac_sp '{}'; allowed: a grasp with three, named ff, mf and th", record.trial, finger));
  }
  return *std::ranges::find(sensor->channels, "electrodes", &SensorColumn::name);
}

// "box_60x50x90": what does not change from grasp to grasp of the same object.
std::string object_name(const std::string& shape, const std::vector<double>& size) {
  std::string name = shape.empty() ? "object" : shape;
  for (std::size_t k = 0; k < size.size(); ++k) name += fmt::format("{}{:.0f}", k == 0 ? '_' : 'x', 1e3 * size[k]);
  return name;
}

std::string row_of(const TrialRecord& record) {
  const BodyRecord& object = body_of(record, "object");
  if (!record.outcome.hold) {
    throw InputError(fmt::format("trial {}: its outcome does not say whether the object was held; allowed: a scene with 'hold'",
                                 record.trial));
  }
  const auto params = nlohmann::json::parse(record.params);
  std::string text =
      fmt::format("{},{}", object_name(params.value("bodies.object.shape", ""), object.size), record.outcome.hold->held ? 0 : 1);
  for (const char* finger : fingers) {
    const SensorColumn& column = electrodes_of(record, finger);
    const auto sensor = std::ranges::find(record.sensors, finger, &SensorRecord::name);
    const std::optional<std::size_t> row = latest_row(sensor->time, record.outcome.hold->from);
    if (!row) throw InputError(fmt::format("trial {}: nothing was read by hold.from", record.trial));
    for (std::size_t e = 0; e < electrodes; ++e) text += fmt::format(",{}", column.values[electrodes * *row + e]);
  }
  return text + '\n';
}

}  // namespace

std::string grasp_csv(const DatasetReader& reader, const std::vector<std::size_t>& trials) {
  std::string text = header();
  for (const std::size_t trial : trials) text += row_of(reader.read_trial(trial));
  return text;
}

bool begins_as_grasp_csv(std::string_view text) { return text.starts_with(first_columns); }

}  // namespace slipbench
