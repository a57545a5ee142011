// The published training files of the PapillArray (RedmondLabUCD): 73 columns without a header, a file a recording.
#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/program/import/import_format.h"
#include "tools/program/import/source_table.h"

namespace slipbench {
namespace {

constexpr std::size_t training_pillars = 9;
constexpr std::size_t training_pillar_columns = 8;  // contact, slip, displacement, force
constexpr std::size_t training_columns = 1 + training_pillars * training_pillar_columns;
constexpr std::size_t training_centre = 4;
constexpr double latest_training = 1e9;  // s
constexpr double most_training_mm = 1e6;
constexpr const char* training_rule =
    "the training files' own: none, some or all of the pillars with contact have the flag slip; the centre pillar does not count in a "
    "file that lies in a folder rotation or combined";
constexpr const char* training_frame =
    "pillars seen from above with the connector at the bottom: x up, y right, z into the sensor, so that compression is positive; "
    "forces act on the sensor, displacements are of its tips";

// What folder and name say: "translation/demo_3-v_4.0-slip.csv".
struct TrainingName {
  std::string move;
  nlohmann::ordered_json params;

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

void read_training_csv(const SourceFile& file, const AddRecording& add) {
  const TrainingName name = training_name(file);
  SensorRecord sensor = make_imported_sensor("pad", "papillarray", 0.0, training_frame, {"force", "displacement"});
  std::vector<std::string> columns{"time"};
  while (columns.size() < training_columns) columns.push_back(training_column(columns.size()));
  SourceTable table(file);
  while (table.next()) {
    table.expect_cells(training_columns);
    table.expect_room(sensor.time.size() + 1, sizeof(double) + training_columns * sizeof(float));
    const double now = table.number(0, columns[0], -latest_training, latest_training);
    if (!sensor.time.empty() && !(now > sensor.time.back()))
      table.fail(fmt::format("column 1, time, is '{}' after {}; allowed: rising times", table.cells()[0], sensor.time.back()));
    sensor.time.push_back(now);
    std::size_t touching = 0, slipping = 0;
    bool contact = false;
    for (std::size_t p = 0; p < training_pillars; ++p) {
      const std::size_t first = 1 + p * training_pillar_columns;
      const bool touches = table.flag(first, columns[first]), slips = table.flag(first + 1, columns[first + 1]);
      contact = contact || touches;
      if (touches && !(name.turns() && p == training_centre)) {
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
    // A centre pillar that touches alone does not slip.
    const PadState state = touching == 0 && contact ? PadState::non_slip : state_of_units(touching, slipping);
    sensor.labels.state_paper.push_back(static_cast<std::uint8_t>(state));
  }
  if (sensor.time.size() < 2)
    table.fail(fmt::format("ends a recording of {} samples; allowed: two at least, which tell the rate", sensor.time.size()));
  sensor.rate = rate_of(sensor.time);
  sensor.labels.rule = training_rule;
  TrialRecord record = make_recording(name.params, "");
  record.body_time = sensor.time;
  record.sensors.push_back(std::move(sensor));
  add(std::move(record), 0);
}

}  // namespace slipbench
