// Layouts of the public BioTac SP recordings. Slip: folder and name from the scene's commands, rows
// from where the motion has reached its speed. Grasps: the row of the log, and what counts as
// slipped. Refusals of both.
#include <algorithm>
#include <vector>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/formats/export/export.h"

namespace slipbench::biotac_csv_test {
namespace {

using slipbench::testing::make_record;

constexpr std::size_t slip_rows = 40;

// Electrode Ee reads 100 e + row, at (row + 1)/100 s.
TrialRecord finger(const std::string& params) {
  TrialRecord record = make_record(3, slip_rows);
  record.params = params;
  SensorRecord& sensor = record.sensors[0];
  sensor.type = "biotac_sp";
  sensor.rate = 100.0;
  sensor.channel_names.clear();
  sensor.channels = {{"electrodes", "counts", {24}, {}}};
  for (int e = 1; e <= 24; ++e) sensor.channel_names.push_back("E" + std::to_string(e));
  for (std::size_t row = 0; row < slip_rows; ++row) {
    sensor.time[row] = 0.01 * static_cast<double>(row + 1);
    for (int e = 1; e <= 24; ++e) sensor.channels[0].values.push_back(static_cast<float>(100 * e + static_cast<int>(row)));
  }
  return record;
}

struct SlipCsv : slipbench::testing::FolderTest {
  std::vector<std::string> exported(const TrialRecord& record, const std::string& scene) {
    slipbench::testing::write_dataset(path("a.h5"), {"1", scene, "{}", 7, "slipbench sweep a.yaml"}, {record});
    ExportOptions options;
    options.format = ExportFormat::slip_csv;
    return export_dataset(path("a.h5"), path("out"), options);
  }
  std::string name(const std::string& params) {
    const std::string scene = "slipbench: 1\nsurface: {material: glass}\nmotion: {kind: rub}\n";
    return exported(finger(params), scene).front().substr(path("out/").size());
  }
};

TEST_F(SlipCsv, FolderIsTheClassThatTheSceneCommands) {
  EXPECT_EQ(name("{}"), "t/glass3.csv");
  EXPECT_EQ(name(R"({"motion.speed": 0.008})"), "n/glass3.csv");
  EXPECT_EQ(name(R"({"motion.speed": 0.008, "motion.direction": 1.5707963267948966})"), "e/glass3.csv");
  EXPECT_EQ(name(R"({"motion.speed": 0.008, "motion.direction": 3.141592653589793})"), "s/glass3.csv");
  EXPECT_EQ(name(R"({"motion.speed": 0.008, "motion.direction": -1.5707963267948966})"), "w/glass3.csv");
  EXPECT_EQ(name(R"({"motion.rotation": 0.6})"), "cw/glass3.csv");
  EXPECT_EQ(name(R"({"motion.rotation": -0.6, "surface.material": "felt", "surface.shape": "cylinder"})"),
            "aw/felt_cylinder3.csv");
}

// A dataset's texts may be foreign, and are part of the name.
TEST_F(SlipCsv, NameStaysInTheFolder) {
  const auto refusal = [&](const std::string& params) { return refusal_of([&] { name(params); }); };
  EXPECT_THAT(refusal(R"({"surface.material": "x/../../../evil"})"), mentions({"t/x/../../../evil3.csv"}));
  EXPECT_THAT(refusal(R"({"surface.material": "glass\u001b[31m"})"), mentions({"t/glass\\x1b[31m3.csv"}));
  EXPECT_EQ(names(), std::vector<std::string>{"a.h5"});
}

// The motion has its speed at start + 2 approach = 0.05 + 0.2 s, row 24: rows 24 to 39 are written.
TEST_F(SlipCsv, BeginsWhereTheMotionHasComeUp) {
  const std::string file = exported(finger("{}"), "slipbench: 1\nmotion: {kind: rub, start: 50 ms, approach: 0.1 s}\n").front();
  const std::vector<std::string> lines = lines_of(bytes_of(file));
  ASSERT_EQ(lines.size(), 1u + 16u);
  EXPECT_THAT(lines[0], StartsWith("ff_e1,ff_e2,"));
  EXPECT_THAT(lines[0], EndsWith(",ff_e24"));
  EXPECT_THAT(lines[1], StartsWith("124,224,"));
  EXPECT_THAT(lines[16], EndsWith(",2439"));
  const std::string whole = exported(finger("{}"), "slipbench: 1\nmotion: {kind: stage, speed: 0 mm/s}\n").front();
  EXPECT_THAT(bytes_of(whole), HasSubstr("ff_e24\n100,200,"));  // all rows of a stage
}

TEST_F(SlipCsv, RefusesWhatIsNoClass) {
  const auto message = [&](const TrialRecord& record) {
    return refusal_of([&] { exported(record, "slipbench: 1\nmotion: {kind: rub}\n"); });
  };
  EXPECT_THAT(message(finger(R"({"motion.speed": 0.008, "motion.rotation": 1.0})")), mentions({"slides", "turns"}));
  EXPECT_THAT(message(finger(R"({"motion.speed": 0.008, "motion.direction": 0.5})")), mentions({"90", "180", "270 deg"}));
  TrialRecord other = finger("{}");
  other.sensors[0].rate = 200.0;
  EXPECT_THAT(message(other), mentions({"200 Hz", "100 Hz"}));
  other.sensors[0].type = "papillarray";
  EXPECT_THAT(message(other), mentions({"papillarray", "biotac_sp"}));
}

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

// Held or not, as the outcome states, from row 2 on.
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
  const std::vector<std::string> lines = lines_of(exported({grasp(0, true), grasp(1, false)}));
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
  EXPECT_THAT(refusal_of([&] { exported({two}); }), mentions({"biotac_sp", "th"}));
  TrialRecord bare = grasp(0, true);
  bare.bodies[0].name = "ball";
  EXPECT_THAT(refusal_of([&] { exported({bare}); }), mentions({"truth/object"}));
  TrialRecord still = grasp(0, true);
  still.outcome.hold.reset();
  EXPECT_THAT(refusal_of([&] { exported({still}); }), mentions({"held", "hold"}));
}

}  // namespace
}  // namespace slipbench::biotac_csv_test
