// Recordings of a BioTac SP that slides, turns or rests (yayaneath/BioTacSP-DoS): a folder a class, a file a recording.
#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "sim/core/error.h"
#include "tools/program/import/import_format.h"
#include "tools/program/import/source_table.h"

namespace slipbench {
namespace {

constexpr std::size_t dos_electrodes = 24;
constexpr double dos_rate = 100.0;          // Hz, nominal: the files have no time
constexpr double most_dos_counts = 4095.0;  // of the converter
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
    throw InputError(fmt::format("{}: lies in a folder called {}; allowed: {}, the class of its recordings", file.path,
                                 quote(name.slip_class), fmt::join(dos_classes, ", ")));
  }
  const std::size_t letters = name.object.find_last_not_of("0123456789") + 1;
  name.number = name.object.substr(letters);
  name.object.resize(letters);
  if (name.object.empty()) {
    throw InputError(fmt::format("{}: its name says no object; allowed: object and number, as in case112.csv", file.path));
  }
  return name;
}

}  // namespace

void read_biotacsp_dos(const SourceFile& file, const AddRecording& add) {
  const DosName name = dos_name(file);
  std::vector<std::string> columns;
  for (std::size_t e = 1; e <= dos_electrodes; ++e) columns.push_back(fmt::format("ff_e{}", e));
  SensorRecord sensor = make_imported_sensor("pad", "biotac_sp", dos_rate, dos_frame, {"electrodes"});
  SourceTable table(file);
  table.expect_header(columns);
  while (table.next()) {
    table.expect_cells(columns.size());
    table.expect_room(sensor.time.size() + 1, sizeof(double) + columns.size() * sizeof(float));
    sensor.time.push_back(static_cast<double>(sensor.time.size()) / dos_rate);
    for (std::size_t e = 0; e < dos_electrodes; ++e)
      sensor.channels[0].values.push_back(static_cast<float>(table.number(e, columns[e], 0.0, most_dos_counts)));
  }
  if (sensor.time.empty()) table.fail("is the only line; allowed: a header and a row a sample");
  const PadState state = name.slip_class == "t" ? PadState::non_slip : PadState::gross;
  sensor.labels.rule = dos_rule;
  sensor.labels.state_paper.assign(sensor.time.size(), static_cast<std::uint8_t>(state));
  nlohmann::ordered_json params{{"object", name.object}, {"class", name.slip_class}};
  if (!name.number.empty()) params["number"] = name.number;
  params["file"] = file.name;
  TrialRecord record = make_recording(params, name.object);
  record.body_time = sensor.time;
  record.sensors.push_back(std::move(sensor));
  add(std::move(record), 0);
}

}  // namespace slipbench
