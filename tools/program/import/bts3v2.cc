// Grasps with three BioTac SP (3dperceptionlab, bts3v2): a row a grasp, read before the lift.
#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/program/import/import_format.h"
#include "tools/program/import/source_table.h"

namespace slipbench {
namespace {

constexpr std::array<const char*, 3> fingers{"ff", "mf", "th"};
constexpr std::size_t electrodes_a_finger = 24;
constexpr std::size_t before_electrodes = 2;  // columns
constexpr double most_counts = 4095.0;        // of the converter
constexpr double nominal_rate = 100.0;        // Hz, of the log that the row was taken from
constexpr const char* grasp_rule =
    "bts3v2: gross where the set says that the lifted object slipped, else non-slip; the row is from before the lift";
constexpr const char* finger_frame = "electrodes E1 to E24 of the fingertip, counts as recorded: pressed skin lowers them";

std::vector<std::string> grasp_columns() {
  std::vector<std::string> names{"object", "slipped"};
  for (const char* finger : fingers) {
    for (std::size_t e = 1; e <= electrodes_a_finger; ++e) names.push_back(fmt::format("{}_biotac_{}", finger, e));
  }
  return names;
}

// "45" of "bts3v2_palm_45.csv"; empty: the name does not say.
std::string palm_of(const SourceFile& file) {
  constexpr std::string_view mark = "palm_";
  const std::string stem = std::filesystem::path(file.path).stem().string();
  const std::size_t at = stem.rfind(mark);
  return at == std::string::npos ? "" : stem.substr(at + mark.size());
}

}  // namespace

void read_bts3v2(const SourceFile& file, const AddRecording& add) {
  const std::vector<std::string> columns = grasp_columns();
  std::vector<SensorRecord> sensors;
  for (const char* finger : fingers)
    sensors.push_back(make_imported_sensor(finger, "biotac_sp", nominal_rate, finger_frame, {"electrodes"}));
  const std::string palm = palm_of(file);
  SourceTable table(file);
  table.expect_header(columns);
  while (table.next()) {
    table.expect_cells(columns.size());
    const std::string object(table.cells()[0]);
    if (!is_plain_name(object)) table.fail(fmt::format("column 1, object, is {}; allowed: a name", quote(object)));
    const bool slipped = table.flag(1, "slipped");
    nlohmann::ordered_json params{{"object", object}};
    if (!palm.empty()) params["palm"] = palm;
    params.update(nlohmann::ordered_json{{"slipped", slipped}, {"file", file.name}, {"row", table.line() - 1}});
    TrialRecord record = make_recording(params, object);
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    record.outcome.grasp = {.dropped = slipped, .max_grip_force = unknown, .final_grip_force = unknown};
    record.body_time = {0.0};
    record.sensors = sensors;
    std::size_t cell = before_electrodes;
    for (SensorRecord& sensor : record.sensors) {
      sensor.time = {0.0};
      for (std::size_t e = 0; e < electrodes_a_finger; ++e, ++cell)
        sensor.channels[0].values.push_back(static_cast<float>(table.number(cell, columns[cell], 0.0, most_counts)));
      sensor.labels.rule = grasp_rule;
      sensor.labels.state_paper = {static_cast<std::uint8_t>(slipped ? PadState::gross : PadState::non_slip)};
    }
    add(std::move(record), 0);
  }
  if (table.line() == 1) table.fail("is the only line; allowed: a header and a row a grasp");
}

}  // namespace slipbench
