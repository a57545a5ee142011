#include "tools/trial/sweep/finished_trial.h"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "sim/core/error.h"

namespace slipbench {
namespace {

using nlohmann::json;

json of_array(const EncodedArray& array) {
  json chunks = json::array();
  for (const std::vector<std::uint8_t>& chunk : array.chunks) chunks.push_back(json::binary(chunk));
  return {array.path, array.unit, array.codes, array.type, array.shape, array.chunk_rows, std::move(chunks)};
}

EncodedArray array_of(json& value) {
  EncodedArray array{value.at(0), value.at(1), value.at(2), value.at(3), value.at(4), value.at(5), {}};
  for (json& chunk : value.at(6)) array.chunks.push_back(std::move(chunk.get_binary()));
  return array;
}

// The value follows the index of its type in the variant.
json of_attribute(const EncodedAttribute& attribute) {
  json value = std::visit(
      [](const auto& held) -> json {
        if constexpr (requires { held.shape; }) {
          return {held.shape, held.values};
        } else {
          return held;
        }
      },
      attribute.value);
  return {attribute.path, attribute.name, attribute.value.index(), std::move(value)};
}

EncodedAttribute attribute_of(const json& value) {
  EncodedAttribute attribute{value.at(0), value.at(1), {}};
  const json& held = value.at(3);
  switch (value.at(2).get<std::size_t>()) {
    case 0: attribute.value = held.get<std::uint64_t>(); break;
    case 1: attribute.value = held.get<double>(); break;
    case 2: attribute.value = held.get<std::string>(); break;
    case 3: attribute.value = held.get<std::vector<std::string>>(); break;
    case 4: attribute.value = EncodedAttribute::Doubles{held.at(0), held.at(1)}; break;
    default: throw std::runtime_error("an attribute of an unknown type");
  }
  return attribute;
}

json of_encoded(const EncodedTrial& trial) {
  json arrays = json::array(), attributes = json::array();
  for (const EncodedArray& array : trial.arrays) arrays.push_back(of_array(array));
  for (const EncodedAttribute& attribute : trial.attributes) attributes.push_back(of_attribute(attribute));
  return {trial.trial, trial.material, std::move(arrays), std::move(attributes), trial.digest};
}

EncodedTrial encoded_of(json& value) {
  EncodedTrial trial{value.at(0), value.at(1), {}, {}, value.at(4)};
  for (json& array : value.at(2)) trial.arrays.push_back(array_of(array));
  for (const json& attribute : value.at(3)) trial.attributes.push_back(attribute_of(attribute));
  return trial;
}

json of_sensor(const SensorSummary& sensor) {
  json units = json::array();
  for (const UnitOutcome& unit : sensor.units) {
    units.push_back({unit.touch_time, unit.micro_onset_time, unit.onset_time, unit.slip_distance, unit.load, unit.margin});
  }
  return {sensor.name, std::move(units), sensor.state_count, sensor.state_micro_count};
}

SensorSummary sensor_of(const json& value) {
  SensorSummary sensor{value.at(0), {}, value.at(2), value.at(3)};
  for (const json& unit : value.at(1)) {
    sensor.units.push_back({unit.at(0), unit.at(1), unit.at(2), unit.at(3), unit.at(4), unit.at(5)});
  }
  return sensor;
}

json of_summary(const TrialSummary& summary) {
  json sensors = json::array(), detector;
  for (const SensorSummary& sensor : summary.sensors) sensors.push_back(of_sensor(sensor));
  if (summary.detector)
    detector = {summary.detector->type, summary.detector->sensor, summary.detector->confusion, summary.detector->notice};
  return {summary.trial,      summary.params, outcome_json(summary.outcome), std::move(sensors), std::move(detector),
          summary.controller, summary.resumed};
}

TrialSummary summary_of(const json& value) {
  TrialSummary summary{.trial = value.at(0),
                       .params = value.at(1),
                       .outcome = parse_outcome(value.at(2)),
                       .sensors = {},
                       .detector = {},
                       .controller = value.at(5),
                       .resumed = value.at(6)};
  for (const json& sensor : value.at(3)) summary.sensors.push_back(sensor_of(sensor));
  if (const json& detector = value.at(4); !detector.is_null())
    summary.detector = DetectorSummary{detector.at(0), detector.at(1), detector.at(2), detector.at(3)};
  return summary;
}

}  // namespace

FinishedTrial failed_trial(std::size_t trial, const std::string& why) {
  FinishedTrial failed;
  failed.summary.trial = trial;
  failed.failure = printable(why, true);  // may quote bytes of a file; a dataset stores UTF-8
  return failed;
}

TrialSummary summary_of(TrialResult& result) {
  const TrialRecord& record = result.record;
  TrialSummary summary{.trial = record.trial, .params = record.params, .outcome = record.outcome, .sensors = {}, .detector = {}};
  for (std::size_t i = 0; i < record.sensors.size(); ++i) {
    const SensorRecord& sensor = record.sensors[i];
    summary.sensors.push_back(
        {sensor.name, std::move(result.units[i]), sensor.labels.state_count, sensor.labels.state_micro_count});
  }
  if (record.control) summary.controller = record.control->controller;
  if (record.control && !record.control->detector.empty()) {
    summary.detector = {record.control->detector, record.control->sensor, record.control->confusion, result.notice};
  }
  return summary;
}

std::string to_message(const FinishedTrial& trial) {
  const json value = {of_summary(trial.summary), trial.duration, trial.computed,
                      trial.time_step,           trial.failure,  trial.encoded ? of_encoded(*trial.encoded) : json()};
  std::string message;
  json::to_msgpack(value, message);
  return message;
}

FinishedTrial from_message(std::string_view message) {
  json value = json::from_msgpack(message);
  FinishedTrial trial{summary_of(value.at(0)), value.at(1), value.at(2), value.at(3), std::nullopt, value.at(4)};
  if (!value.at(5).is_null()) trial.encoded = encoded_of(value.at(5));
  return trial;
}

}  // namespace slipbench
