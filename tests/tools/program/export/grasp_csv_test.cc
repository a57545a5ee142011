// The table of grasps with three BioTac SP: which row of the log it takes, what counts as slipped, what it refuses.
#include <algorithm>
#include <sstream>

#include "tests/expect.h"
#include "tests/tools/base/record/test_records.h"
#include "tools/program/export/export.h"

namespace slipbench::grasp_csv_test {
namespace {

using slipbench::testing::make_record;

constexpr std::size_t rows = 6;

// Electrode e of a finger reads 1000 finger + 100 row + e.
SensorRecord finger(const std::string& name, int number) {
  SensorRecord sensor = make_record(0, rows).sensors[0];
  sensor.name = name;
  sensor.type = "biotac_sp";
  sensor.rate = 100.0;
  sensor.channel_names.clear();
  sensor.channels = {{"electrodes", "counts", {24}, {}, std::vector<double>{}}};
  for (int e = 0; e < 24; ++e) sensor.channel_names.push_back("E" + std::to_string(e + 1));
  for (std::size_t row = 0; row < rows; ++row) {
    sensor.time[row] = 0.01 * static_cast<double>(row + 1);
    sensor.channels[0].time->push_back(sensor.time[row] - 6.75e-3);
    for (int e = 1; e <= 24; ++e)
      sensor.channels[0].values.push_back(static_cast<float>(1000 * number + 100 * static_cast<int>(row) + e));
  }
  return sensor;
}

// Held or not, as its outcome says from row 2 on.
TrialRecord grasp(std::size_t trial, bool held) {
  TrialRecord record = make_record(trial, rows);
  record.sensors = {finger("ff", 1), finger("mf", 2), finger("th", 3)};
  record.params = R"({"bodies.object.shape": "box"})";
  record.body_time = record.sensors[0].time;
  record.bodies = {{"object", std::vector<float>(7 * rows), std::vector<float>(6 * rows), {0.06, 0.05, 0.09}}};
  record.outcome.hold = {.held = held, .from = 0.0301, .moved = held ? 0.0 : 0.04};
  return record;
}

struct GraspCsv : slipbench::testing::FolderTest {
  std::string exported(const std::vector<TrialRecord>& records) {
    slipbench::testing::write_dataset(path("a.h5"), {"1", "slipbench: 1\n", "{}", 7, "slipbench sweep a.yaml"}, records);
    const auto files = export_dataset(path("a.h5"), path("out"), {ExportFormat::grasp_csv, {}, {}, {}, {}, {}});
    EXPECT_THAT(files, ElementsAre(path("out/grasps.csv")));
    return bytes_of(files.front());
  }
};

TEST_F(GraspCsv, HasARowAGraspOfTheLastReadingBeforeItHasToHold) {
  std::istringstream text(exported({grasp(0, true), grasp(1, false)}));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_THAT(lines[0], StartsWith("object,slipped,ff_biotac_1,ff_biotac_2,"));
  EXPECT_THAT(lines[0], HasSubstr(",ff_biotac_24,mf_biotac_1,"));
  EXPECT_THAT(lines[0], EndsWith(",th_biotac_24"));
  // Row 2, at 0.03 s.
  EXPECT_THAT(lines[1], StartsWith("box_60x50x90,0,1201,1202,"));
  EXPECT_THAT(lines[1], HasSubstr(",1224,2201,"));
  EXPECT_THAT(lines[1], EndsWith(",3224"));
  EXPECT_THAT(lines[2], StartsWith("box_60x50x90,1,1201,"));
  for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 73);
}

TEST_F(GraspCsv, RefusesWhatIsNoSuchGrasp) {
  TrialRecord two = grasp(0, true);
  two.sensors.pop_back();
  EXPECT_THAT(refusal_of([&] { exported({two}); }), HasSubstr("no biotac_sp 'th'; allowed: a grasp with three"));
  TrialRecord bare = grasp(0, true);
  bare.bodies[0].name = "ball";
  EXPECT_THAT(refusal_of([&] { exported({bare}); }), HasSubstr("has no truth/object"));
  TrialRecord still = grasp(0, true);
  still.outcome.hold.reset();
  EXPECT_THAT(refusal_of([&] { exported({still}); }),
              HasSubstr("does not say whether the object was held; allowed: a scene with 'hold'"));
}

}  // namespace
}  // namespace slipbench::grasp_csv_test
