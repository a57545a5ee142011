#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "detectors/channel.h"
#include "sim/core/counted.h"
#include "sim/core/error.h"
#include "tools/formats/import/source_table.h"
#include "tools/learning_data/samples.h"

namespace slipbench {
namespace {

constexpr std::size_t log_sensor_columns = 81;                                              // of one sensor, after the time
constexpr std::size_t log_pillar_columns = 6;                                               // displacement and force
constexpr std::size_t log_load_columns = 6;                                                 // force and torque of all pillars
constexpr std::size_t log_active_column = pillars * log_pillar_columns + log_load_columns;  // isSDActive
constexpr std::size_t log_states_column = log_active_column + 2;                            // of the first pillar
constexpr double latest_log = 1e15;                                                         // us
constexpr double smallest_log_time = 0.0;
constexpr const char* log_rule =
    "the device's own slip detection: none, some or all of the pillars in contact (slipState 1, 2 or 3) are in state 3";
constexpr const char* device_frame =
    "pillars seen from above with the connector at the bottom: x up, y right, z into the sensor, so that compression is positive; "
    "forces act on the sensor, displacements are of its tips";

// Names of the header. The manual prints those of the second sensor's slip detection with the first
// sensor's number, so both are accepted.
std::vector<std::string> read_log_header(SourceTable& table) {
  if (!table.next()) table.fail("the file is empty; expected a header that begins with T_us");
  const std::size_t found = table.cells().size();
  const std::size_t sensors = found > log_sensor_columns + 1 ? 2 : 1;
  std::vector<std::string> names = vendor_log_columns(sensors);
  for (std::size_t i = 0; i < std::min(names.size(), found); ++i) {
    const std::string cell(table.cells()[i]);
    const bool printed = i > log_sensor_columns + log_active_column &&
                         names[i].substr(2) == cell.substr(std::min<std::size_t>(2, cell.size())) && cell.starts_with("S0");
    if (cell != names[i] && !printed)
      table.fail(fmt::format("column {} is called {}; expected '{}'", i + 1, quote(cell), names[i]));
  }
  if (found != names.size())
    table.fail(fmt::format("has {}; expected 82 for one sensor or 163 for two", counted(found, "column")));
  return names;
}

// State of reading one sensor of a log.
struct LoggedSensor {
  SensorRecord record;
  bool always_active = true;

  void add(const SourceTable& table, const std::vector<std::string>& names, std::size_t first) {
    for (std::size_t p = 0; p < pillars; ++p) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t cell = first + p * log_pillar_columns + axis;
        constexpr double most = 1e6;  // mm
        record.channels[1].values.push_back(static_cast<float>(table.number(cell, names[cell], -most, most) / 1e3));
        record.channels[0].values.push_back(table.value(cell + 3, names[cell + 3]));
      }
    }
    // Columns derived from the pillars, or unrelated to them, are checked to be numbers but not
    // stored.
    for (std::size_t i = 0; i < log_load_columns; ++i) {
      const std::size_t cell = first + pillars * log_pillar_columns + i;
      static_cast<void>(table.value(cell, names[cell]));
    }
    const std::size_t active = first + log_active_column, friction = first + log_sensor_columns - 1;
    static_cast<void>(table.flag(active + 1, names[active + 1]));
    static_cast<void>(table.value(friction, names[friction]));
    const bool is_active = table.flag(active, names[active]);
    always_active = always_active && is_active;
    constexpr std::array<int, 5> states{-2, -1, 1, 2, 3};
    constexpr std::array<int, 6> idle_states{-2, -1, 0, 1, 2, 3};
    std::size_t touching = 0, slipping = 0;
    for (std::size_t p = 0; p < pillars; ++p) {
      const std::size_t cell = first + log_states_column + 2 * p;
      static_cast<void>(table.flag(cell, names[cell]));
      const int state =
          is_active ? table.one_of(cell + 1, names[cell + 1], states) : table.one_of(cell + 1, names[cell + 1], idle_states);
      touching += state > 0 ? 1 : 0;
      slipping += state == 3 ? 1 : 0;
    }
    record.labels.state_paper.push_back(static_cast<std::uint8_t>(UnitCounts{touching, slipping}.state()));
  }
};

constexpr std::size_t training_pillar_columns = 8;  // contact, slip, displacement, force
constexpr std::size_t training_columns = 1 + pillars * training_pillar_columns;
constexpr double latest_training = 1e9;  // s
constexpr double most_training_mm = 1e6;
constexpr const char* training_rule =
    "the training files' own: none, some or all of the pillars with contact have the flag slip; the centre pillar does not count in a "
    "file that lies in a folder rotation or combined";

// Folder and name of a training file: "translation/demo_3-v_4.0-slip.csv".
struct TrainingName {
  std::string move;
  Json params;

  [[nodiscard]] bool turns() const { return move == "rotation" || move == "combined"; }
};

TrainingName training_name(const SourceFile& file) {
  const std::filesystem::path path = std::filesystem::absolute(file.path).lexically_normal();
  TrainingName name{path.parent_path().filename().string(), {{"file", file.name}}};
  constexpr std::array<std::string_view, 4> moves{"translation", "rotation", "combined", "press"};
  if (std::ranges::find(moves, name.move) != moves.end()) name.params["move"] = name.move;
  const std::string stem = path.stem().string();
  const std::size_t end = stem.rfind('-');
  const std::size_t speed = stem.rfind("-v_");
  if (end == std::string::npos || speed == std::string::npos || speed >= end) return name;
  const std::string_view word = std::string_view(stem).substr(end + 1),
                         digits = std::string_view(stem).substr(speed + 3, end - speed - 3);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || stop != digits.data() + digits.size() || (word != "slip" && word != "stop")) return name;
  name.params["speed_mm_s"] = value;
  name.params["end"] = word;
  return name;
}

std::string training_column(std::size_t cell) {
  constexpr std::array<const char*, training_pillar_columns> parts{"contact", "slip", "DX", "DY", "DZ", "FX", "FY", "FZ"};
  return fmt::format("P{} {}", (cell - 1) / training_pillar_columns, parts[(cell - 1) % training_pillar_columns]);
}

}  // namespace

void read_papillarray_csv(const SourceFile& file, const AddRecording& add) {
  SourceTable table(file);
  const std::vector<std::string> names = read_log_header(table);
  const std::size_t count = names.size() / log_sensor_columns;
  std::vector<LoggedSensor> sensors;
  for (std::size_t s = 0; s < count; ++s) {
    sensors.push_back({make_imported_sensor(count == 1 ? "pad" : fmt::format("s{}", s), "papillarray", 0.0, device_frame,
                                            {"force", "displacement"})});
  }
  std::vector<double> time;
  std::string before;
  std::size_t repeated = 0;
  double resolution = std::numeric_limits<double>::infinity();  // s
  while (table.next()) {
    if (table.text() == before) {  // a program that logs faster than the device samples writes rows twice
      ++repeated;
      continue;
    }
    before = table.text();
    table.expect_cells(names.size());
    table.expect_room(time.size() + 1, 2 * sizeof(float) * names.size());
    const double now = table.number(0, "T_us", smallest_log_time, latest_log) / 1e6;
    if (!time.empty() && !(now > time.back())) {
      table.fail(fmt::format("column 1, T_us, is '{}' after {:.0f}; expected ascending times, or a repeated row",
                             table.cells()[0], 1e6 * time.back()));
    }
    time.push_back(now);
    resolution = std::min(resolution, resolution_of(table.cells()[0]) / 1e6);
    for (std::size_t s = 0; s < count; ++s) sensors[s].add(table, names, 1 + s * log_sensor_columns);
  }

  bool detects = true;
  for (LoggedSensor& sensor : sensors) {
    sensor.record.time = time;
    set_timing(table, resolution, sensor.record);
    sensor.record.labels.rule = log_rule;
    if (!sensor.always_active) sensor.record.labels.state_paper.clear();
    detects = detects && sensor.always_active;
  }
  Json params{{"file", file.name}, {"slip_detection", detects}};
  if (repeated > 0) params["repeated_rows"] = repeated;
  TrialRecord record = make_recording(params, "");
  for (LoggedSensor& sensor : sensors) record.sensors.push_back(std::move(sensor.record));
  record.body_time = std::move(time);
  add(std::move(record), repeated);
}

// Reads the published training files of the PapillArray (RedmondLabUCD): 73 columns without a
// header, one file per recording.
void read_training_csv(const SourceFile& file, const AddRecording& add) {
  const TrainingName name = training_name(file);
  SensorRecord sensor = make_imported_sensor("pad", "papillarray", 0.0, device_frame, {"force", "displacement"});
  std::vector<std::string> columns{"time"};
  while (columns.size() < training_columns) columns.push_back(training_column(columns.size()));
  SourceTable table(file);
  double resolution = std::numeric_limits<double>::infinity();  // s
  while (table.next()) {
    table.expect_cells(training_columns);
    table.expect_room(sensor.time.size() + 1, sizeof(double) + training_columns * sizeof(float));
    const double now = table.number(0, columns[0], -latest_training, latest_training);
    if (!sensor.time.empty() && !(now > sensor.time.back()))
      table.fail(fmt::format("column 1, time, is '{}' after {}; expected ascending times", table.cells()[0], sensor.time.back()));
    sensor.time.push_back(now);
    resolution = std::min(resolution, resolution_of(table.cells()[0]));
    std::size_t touching = 0, slipping = 0;
    bool contact = false;
    for (std::size_t p = 0; p < pillars; ++p) {
      const std::size_t first = 1 + p * training_pillar_columns;
      const bool touches = table.flag(first, columns[first]), slips = table.flag(first + 1, columns[first + 1]);
      contact = contact || touches;
      if (touches && !(name.turns() && p == middle_pillar)) {
        ++touching;
        slipping += slips ? 1 : 0;
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t length = first + 2 + axis, force = first + 5 + axis;
        sensor.channels[1].values.push_back(
            static_cast<float>(table.number(length, columns[length], -most_training_mm, most_training_mm) / 1e3));
        sensor.channels[0].values.push_back(table.value(force, columns[force]));
      }
    }
    // A pad of which only the centre pillar touches does not slip.
    const PadState state = touching == 0 && contact ? PadState::non_slip : UnitCounts{touching, slipping}.state();
    sensor.labels.state_paper.push_back(static_cast<std::uint8_t>(state));
  }
  set_timing(table, resolution, sensor);
  sensor.labels.rule = training_rule;
  TrialRecord record = make_recording(name.params, "");
  record.body_time = sensor.time;
  record.sensors.push_back(std::move(sensor));
  add(std::move(record), 0);
}

}  // namespace slipbench
