#include "sim/core/counted.h"
#include "tools/formats/export/formats.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

#include <fmt/format.h>

#include "tools/dataset/record/encoder.h"
#include "tools/files/reject.h"
#include "tools/registry/sensor_catalogue.h"

namespace slipbench {
namespace {

constexpr std::string_view first_column = "t [s]";

// Labels of a recording, which has no truth.
constexpr std::string_view recorded_column = ",state_recorded";

struct StateColumn {
  std::string name;
  std::vector<std::uint8_t> LabelRecord::*values;
};

std::string column_of(const LabelRuleInfo& rule) { return "," + array_of(rule); }

std::vector<StateColumn> states_by_rule(std::optional<LabelRule> rule, const LabelRecord& labels) {
  if (!labels.truth && !has_labels(labels)) return {};
  if (!labels.truth) return {{std::string(recorded_column), &LabelRecord::state_paper}};
  std::vector<StateColumn> columns;
  for (const LabelRuleInfo& stored : stored_rules()) {
    if (!rule || stored.value == *rule) columns.push_back({column_of(stored), stored.stored});
  }
  return columns;
}

// A channel, the names of its values and the column computed from them.
struct NamedColumn {
  const SensorColumn* column = nullptr;
  std::span<const std::string> names;
  std::string difference;  // first value minus the second; empty: none

  [[nodiscard]] std::span<const float> row(std::size_t index) const {
    return std::span(column->values).subspan(index * names.size(), names.size());
  }
};

std::vector<NamedColumn> named_columns(const SensorRecord& sensor) {
  std::size_t expected = 0;
  for (const SensorColumn& column : sensor.channels) expected += column.row_size();
  if (sensor.channel_names.size() != expected) {
    reject("sensor {}: {} for {} per sample", sensor.name, counted(sensor.channel_names.size(), "name"),
           counted(expected, "value"));
  }
  const SensorView view = sensor_kind(sensor.type).view;
  std::vector<NamedColumn> columns;
  std::span<const std::string> names = sensor.channel_names;
  for (const SensorColumn& column : sensor.channels) {
    const std::size_t count = column.row_size();
    const std::string difference = view.channel_view(column.name).difference;
    if (!difference.empty() && count != 2) {
      reject("sensor {}: channel '{}' has {}, expected 2", sensor.name, column.name, counted(count, "value"));
    }
    columns.push_back({&column, names.first(count), difference});
    names = names.subspan(count);
  }
  return columns;
}

// A table of the columns that share `time`. The truth is from the sensor's latest sample.
std::string table_of(const SensorRecord& sensor, const std::vector<double>& time, std::span<const NamedColumn> columns,
                     const std::vector<StateColumn>& states) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}", first_column);
  for (const NamedColumn& column : columns) {
    if (!column.difference.empty()) fmt::format_to(out, ",{} [{}]", column.difference, column.column->unit);
    for (const std::string& name : column.names) fmt::format_to(out, ",{} [{}]", name, column.column->unit);
  }
  for (const StateColumn& state : states) fmt::format_to(out, "{}", state.name);
  text.push_back('\n');
  for (std::size_t row = 0; row < time.size(); ++row) {
    fmt::format_to(out, "{}", time[row]);
    for (const NamedColumn& column : columns) {
      const std::span<const float> values = column.row(row);
      if (!column.difference.empty()) fmt::format_to(out, ",{}", values[0] - values[1]);
      for (const float value : values) fmt::format_to(out, ",{}", value);
    }
    const std::optional<std::size_t> truth = latest_row(sensor.time, time[row]);
    for (const StateColumn& state : states) {
      const std::vector<std::uint8_t>& values = sensor.labels.*state.values;
      text.push_back(',');
      if (truth) fmt::format_to(out, "{}", values[*truth]);
    }
    text.push_back('\n');
  }
  return fmt::to_string(text);
}

}  // namespace

std::vector<CsvTable> table_csv(const SensorRecord& sensor, std::optional<LabelRule> rule) {
  const std::vector<NamedColumn> columns = named_columns(sensor);
  std::vector<NamedColumn> common;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(common),
               [](const NamedColumn& column) { return !column.column->time; });
  const std::vector<StateColumn> states = states_by_rule(rule, sensor.labels);
  std::vector<CsvTable> tables{{"", table_of(sensor, sensor.time, common, states)}};
  for (const NamedColumn& column : columns) {
    if (column.column->time)
      tables.push_back({column.column->name, table_of(sensor, *column.column->time, std::span(&column, 1), states)});
  }
  return tables;
}

bool begins_as_table_csv(std::string_view text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  const bool ends =
      std::ranges::any_of(stored_rules(), [&](const LabelRuleInfo& rule) { return line.ends_with(column_of(rule)); });
  const bool recording = line.ends_with(recorded_column) || line.ends_with(']');
  return line.starts_with(first_column) && (ends || recording || line.size() == text.size());
}

}  // namespace slipbench
