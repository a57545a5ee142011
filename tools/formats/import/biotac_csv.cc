#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/files/reject.h"
#include "tools/formats/import/source_table.h"
#include "tools/learning_data/samples.h"

namespace slipbench {
namespace {

constexpr double nominal_rate = 100.0;  // Hz; the files of both sets have no time stamps
constexpr double most_counts = 4095.0;  // maximum of the converter
// North, east, south, west, clockwise, anticlockwise, touch.
constexpr std::array<std::string_view, 7> dos_classes{"n", "e", "s", "w", "cw", "aw", "t"};
constexpr const char* dos_rule = "BioTacSP-DoS: non-slip throughout a recording of class t (touch), gross throughout the others";
constexpr const char* dos_frame =
    "electrodes E1 to E24 of the fingertip, counts as recorded: pressed skin lowers them; rows at a nominal 100 Hz, of which each "
    "electrode is new in five of seven";

struct DosName {
  std::string slip_class, object, number;
};

DosName dos_name(const SourceFile& file) {
  const std::filesystem::path path = std::filesystem::absolute(file.path).lexically_normal();
  DosName name{path.parent_path().filename().string(), path.stem().string(), ""};
  if (std::ranges::find(dos_classes, name.slip_class) == dos_classes.end()) {
    reject("{}: is in a folder called {}; the folder must be named after the class of its recordings: {}", file.path,
           quote(name.slip_class), fmt::join(dos_classes, ", "));
  }
  const std::size_t letters = name.object.find_last_not_of("0123456789") + 1;
  name.number = name.object.substr(letters);
  name.object.resize(letters);
  if (name.object.empty()) reject("{}: its name has no object; expected object and number, such as case112.csv", file.path);
  return name;
}

constexpr std::size_t before_electrodes = 2;  // columns
constexpr const char* grasp_rule =
    "bts3v2: gross where the set says that the lifted object slipped, else non-slip; the row is from before the lift";
constexpr const char* finger_frame = "electrodes E1 to E24 of the fingertip, counts as recorded: pressed skin lowers them";

// "45" for "bts3v2_palm_45.csv"; empty if the name does not state the angle.
std::string palm_of(const SourceFile& file) {
  constexpr std::string_view mark = "palm_";
  const std::string stem = std::filesystem::path(file.path).stem().string();
  const std::size_t at = stem.rfind(mark);
  return at == std::string::npos ? "" : stem.substr(at + mark.size());
}

}  // namespace

void read_biotacsp_dos(const SourceFile& file, const AddRecording& add) {
  const DosName name = dos_name(file);
  std::vector<std::string> columns;
  for (std::size_t e = 1; e <= finger_electrodes; ++e) columns.push_back(fmt::format("ff_e{}", e));
  SensorRecord sensor = make_imported_sensor("pad", "biotac_sp", nominal_rate, dos_frame, {"electrodes"});
  SourceTable table(file);
  table.expect_header(columns);
  while (table.next()) {
    table.expect_cells(columns.size());
    table.expect_room(sensor.time.size() + 1, sizeof(double) + columns.size() * sizeof(float));
    sensor.time.push_back(static_cast<double>(sensor.time.size()) / nominal_rate);
    for (std::size_t e = 0; e < finger_electrodes; ++e)
      sensor.channels[0].values.push_back(static_cast<float>(table.number(e, columns[e], 0.0, most_counts)));
  }
  if (sensor.time.empty()) table.fail("is the only line; expected a header and one row per sample");
  const PadState state = name.slip_class == "t" ? PadState::non_slip : PadState::gross;
  sensor.labels.rule = dos_rule;
  sensor.labels.state_paper.assign(sensor.time.size(), static_cast<std::uint8_t>(state));
  Json params{{"object", name.object}, {"class", name.slip_class}};
  if (!name.number.empty()) params["number"] = name.number;
  params["file"] = file.name;
  TrialRecord record = make_recording(params, name.object);
  record.body_time = sensor.time;
  record.sensors.push_back(std::move(sensor));
  add(std::move(record), 0);
}

// Reads grasps with three BioTac SP (3dperceptionlab, bts3v2): one row per grasp, recorded before
// the lift.
void read_bts3v2(const SourceFile& file, const AddRecording& add) {
  const std::vector<std::string> columns = grasp_columns();
  std::vector<SensorRecord> sensors;
  for (const char* finger : grasp_fingers)
    sensors.push_back(make_imported_sensor(finger, "biotac_sp", nominal_rate, finger_frame, {"electrodes"}));
  const std::string palm = palm_of(file);
  SourceTable table(file);
  table.expect_header(columns);
  while (table.next()) {
    table.expect_cells(columns.size());
    const std::string object(table.cells()[0]);
    if (!is_plain_name(object)) table.fail(fmt::format("column 1, object, is {}; expected a name", quote(object)));
    const bool slipped = table.flag(1, "slipped");
    Json params{{"object", object}};
    if (!palm.empty()) params["palm"] = palm;
    params.update(Json{{"slipped", slipped}, {"file", file.name}, {"row", table.line() - 1}});
    TrialRecord record = make_recording(params, object);
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    record.outcome.grasp = {.dropped = slipped, .max_grip_force = unknown, .final_grip_force = unknown};
    record.body_time = {0.0};
    record.sensors = sensors;
    std::size_t cell = before_electrodes;
    for (SensorRecord& sensor : record.sensors) {
      sensor.time = {0.0};
      for (std::size_t e = 0; e < finger_electrodes; ++e, ++cell)
        sensor.channels[0].values.push_back(static_cast<float>(table.number(cell, columns[cell], 0.0, most_counts)));
      sensor.labels.rule = grasp_rule;
      sensor.labels.state_paper = {static_cast<std::uint8_t>(slipped ? PadState::gross : PadState::non_slip)};
    }
    add(std::move(record), 0);
  }
  if (table.line() == 1) table.fail("is the only line; expected a header and one row per grasp");
}

}  // namespace slipbench
