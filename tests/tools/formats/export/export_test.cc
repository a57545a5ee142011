#include "tools/formats/export/export.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/writer.h"
#include "tools/formats/export/formats.h"

namespace slipbench::testing {
namespace {

constexpr std::size_t pillars = 9;
constexpr std::size_t rows = 5;

// A PapillArray whose pillar p reads in row r displacement (p, r, 1) um and force (0.1 p, -0.1 r,
// 1) N. Its tips are 7 mm apart at height 0, so that the deformed tips differ by the displacements
// alone.
SensorRecord make_sensor(const std::string& name, double rate, std::size_t samples = rows) {
  SensorRecord sensor;
  sensor.name = name;
  sensor.type = "papillarray";
  sensor.rate = rate;
  sensor.channel_names.assign(54, "x");
  LabelRecord& labels = sensor.labels;
  std::vector<float> force;
  std::vector<float> displacement;
  for (std::size_t r = 0; r < samples; ++r) {
    sensor.time.push_back(static_cast<double>(r) / rate);
    for (std::size_t p = 0; p < pillars; ++p) {
      const auto x = static_cast<float>(p);
      const auto y = static_cast<float>(r);
      displacement.insert(displacement.end(), {1e-6F * x, 1e-6F * y, 1e-6F});
      force.insert(force.end(), {0.1F * x, -0.1F * y, 1.0F});
    }
  }
  labels.force = force;
  sensor.channels = {{"force", "N", {pillars, 3}, force}, {"displacement", "m", {pillars, 3}, displacement}};
  labels.unit_state.assign(samples * pillars, 1);
  labels.slip_velocity.assign(samples * pillars * 2, 0.0F);
  labels.slip_distance.assign(samples * pillars, 0.0F);
  labels.margin.assign(samples * pillars, 0.0F);
  for (auto* column : {&labels.state, &labels.state_micro, &labels.state_paper}) column->assign(samples, 1);
  for (auto* column : {&labels.stuck_fraction, &labels.slip_direction, &labels.slip_angle}) column->assign(samples, 0.0F);
  labels.slip_centre.assign(samples * 2, 0.0F);
  for (std::size_t p = 0; p < pillars; ++p) {
    labels.unit_positions.insert(labels.unit_positions.end(),
                                 {0.007 * (1.0 - static_cast<double>(p % 3)), 0.007 * (1.0 - static_cast<double>(p / 3))});
  }
  for (auto* values : {&labels.unit_heights, &labels.k_normal, &labels.k_tangential, &labels.mu_static, &labels.mu_kinetic,
                       &labels.onset_time, &labels.micro_onset_time}) {
    values->assign(pillars, 0.0);
  }
  return sensor;
}

TrialRecord make_trial_record(std::size_t trial, double rate = 1000.0) {
  TrialRecord record;
  record.trial = trial;
  record.sensors.push_back(make_sensor("pad", rate));
  record.body_time = record.sensors[0].time;
  record.bodies.push_back({"pad", std::vector<float>(rows * 7), std::vector<float>(rows * 6)});
  return record;
}

void set_state(TrialRecord& record, std::size_t row, std::size_t pillar, UnitState state) {
  record.sensors[0].labels.unit_state[row * pillars + pillar] = static_cast<std::uint8_t>(state);
}

std::vector<std::vector<std::string>> table_of(const std::string& path) {
  std::vector<std::vector<std::string>> table;
  for (const std::string& line : lines_of(bytes_of(path))) table.push_back(parts_of(line, ','));
  return table;
}

struct ExportTest : FolderTest {
  std::string scene_text = "slipbench: 1\n";
  std::string overrides = "{}";

  std::string dataset(const std::vector<TrialRecord>& records) {
    return write_dataset(path("a.h5"), {"1", scene_text, overrides, 7, "slipbench sweep a.yaml"}, records);
  }
  std::vector<std::string> run(const std::string& from, const ExportOptions& options) {
    return export_dataset(from, path("out"), options);
  }
};

constexpr ExportOptions vendor{ExportFormat::vendor_csv, LabelRule::strict, {}, {}, {}};
constexpr ExportOptions training{ExportFormat::training_csv, LabelRule::strict, {}, {}, {}};

TEST_F(ExportTest, VendorLogHasTheVendorsColumns) {
  EXPECT_THAT(run(dataset({make_trial_record(3)}), vendor), ElementsAre(path("out/LOG_demo_3.csv")));
  const auto table = table_of(path("out/LOG_demo_3.csv"));
  ASSERT_THAT(table, SizeIs(1 + rows));
  // Numbers in the vendor's manual start at 1.
  const std::vector<std::string>& header = table[0];
  ASSERT_THAT(header, SizeIs(82));
  const std::map<std::size_t, std::string> names{
      {0, "T_us"},           {1, "S0_P0_DX"},           {4, "S0_P0_FX"},         {7, "S0_P1_DX"},
      {54, "S0_P8_FZ"},      {55, "S0_GG_FX"},          {58, "S0_GG_TX"},        {61, "S0_isSDActive"},
      {62, "S0_isRefLoad"},  {63, "S0_P0_isInContact"}, {64, "S0_P0_slipState"}, {80, "S0_P8_slipState"},
      {81, "S0_FrictionEst"}};
  for (const auto& [column, name] : names) EXPECT_EQ(header[column], name);
  for (const auto& line : table) EXPECT_THAT(line, SizeIs(82));
}

// A float32 in m and the nearest one in mm are not in one-to-one correspondence: enough digits are
// written to restore the first.
TEST(Millimetres, BringTheSameFloatBack) {
  std::size_t longer = 0;
  for (int k = 1; k <= 20'000; ++k) {
    const float metres = 1.3e-7F * static_cast<float>(k);
    const std::string text = millimetres(metres);
    EXPECT_EQ(static_cast<float>(std::stod(text) / 1e3), metres) << text;
    longer += text != fmt::format("{}", static_cast<float>(1e3 * static_cast<double>(metres))) ? 1 : 0;
  }
  EXPECT_GT(longer, 0u);  // where a float32 in mm would not suffice
  EXPECT_EQ(millimetres(0.00025F), "0.25");
  EXPECT_EQ(millimetres(-0.001F), "-1");
}

TEST_F(ExportTest, VendorLogHasTheVendorsUnits) {
  run(dataset({make_trial_record(0)}), vendor);
  const auto line = table_of(path("out/LOG_demo_0.csv"))[1 + 2];  // row 2, at 2 ms
  EXPECT_EQ(line[0], "2000");
  // Pillar 3: displacement (3, 2, 1) um, force (0.3, -0.2, 1) N.
  EXPECT_FLOAT_EQ(std::stof(line[1 + 3 * 6 + 0]), 0.003F);
  EXPECT_FLOAT_EQ(std::stof(line[1 + 3 * 6 + 1]), 0.002F);
  EXPECT_FLOAT_EQ(std::stof(line[1 + 3 * 6 + 2]), 0.001F);
  EXPECT_EQ(std::stof(line[1 + 3 * 6 + 3]), 0.1F * 3.0F);  // read back to the same float
  EXPECT_EQ(std::stof(line[1 + 3 * 6 + 4]), -0.1F * 2.0F);
  EXPECT_EQ(line[1 + 3 * 6 + 5], "1");
}

TEST_F(ExportTest, VendorLogSumsForceAndTorque) {
  run(dataset({make_trial_record(0)}), vendor);
  const auto line = table_of(path("out/LOG_demo_0.csv"))[1 + 2];
  // Force: 0.1 * (0 + ... + 8) = 3.6 N, -0.2 * 9 = -1.8 N, 9 N.
  EXPECT_NEAR(std::stod(line[55]), 3.6, 1e-6);
  EXPECT_NEAR(std::stod(line[56]), -1.8, 1e-6);
  EXPECT_NEAR(std::stod(line[57]), 9.0, 1e-6);
  // Arms from P4 to pillar p: x = 7 (1 - p%3) + 1e-3 (p - 4), y = 7 (1 - p/3), z = 0 mm; the sums
  // of p - 4, of y and of the grid's x over all pillars are zero. TX = sum(y F_z - z F_y) = 0. TY =
  // sum(z F_x - x F_z) = -sum(x) = 0.
  EXPECT_NEAR(std::stod(line[58]), 0.0, 1e-6);
  EXPECT_NEAR(std::stod(line[59]), 0.0, 1e-6);
  // TZ = sum(x F_y - y F_x) = 0 - 0.7 sum((1 - p/3) p) = -0.7 ((0+1+2) - (6+7+8)) = 12.6 N mm.
  EXPECT_NEAR(std::stod(line[60]), 12.6, 1e-5);
}

TEST_F(ExportTest, VendorLogGivesTheVendorsSlipStates) {
  TrialRecord record = make_trial_record(0);
  LabelRecord& labels = record.sensors[0].labels;
  for (const std::size_t row : {0U, 4U}) set_state(record, row, 0, UnitState::detached);  // touches in between
  set_state(record, 3, 0, UnitState::slip);
  // True force of pillar 0: row 1 sideways 0.1 N, above 0.05 N; row 2 none.
  labels.force[(2 * pillars) * 3 + 1] = 0.0F;
  run(dataset({record}), vendor);
  const auto table = table_of(path("out/LOG_demo_0.csv"));
  EXPECT_EQ(table[1][64], "-2");  // not in contact yet
  EXPECT_EQ(table[2][64], "2");   // tangentially loaded
  EXPECT_EQ(table[3][64], "1");   // contact
  EXPECT_EQ(table[4][64], "3");   // slipped
  EXPECT_EQ(table[5][64], "-1");  // lost contact
  EXPECT_EQ(table[1][63], "1");   // reported 1 N is above 0.5 N
  EXPECT_EQ(table[1][61], "1");
  EXPECT_EQ(table[1][62], "1");  // pillar 4 carries 0.4 N sideways
  EXPECT_EQ(table[1][81], "-1");
}

TEST_F(ExportTest, VendorLogHoldsTwoSensorsSideBySide) {
  TrialRecord record = make_trial_record(0);
  record.sensors.push_back(make_sensor("second", 1000.0));
  run(dataset({record}), vendor);
  const auto table = table_of(path("out/LOG_demo_0.csv"));
  ASSERT_THAT(table[0], SizeIs(163));
  EXPECT_EQ(table[0][82], "S1_P0_DX");
  EXPECT_EQ(table[0][162], "S1_FrictionEst");

  record.sensors.push_back(make_sensor("third", 1000.0));
  EXPECT_THAT(refusal_of([&] { run(dataset({record}), vendor); }), mentions({"2 sensors", "3"}));
  record.sensors.pop_back();
  record.sensors[1] = make_sensor("second", 500.0);
  EXPECT_THAT(refusal_of([&] { run(dataset({record}), vendor); }), mentions({"different times"}));
}

TEST_F(ExportTest, TrainingFileHas73Columns) {
  TrialRecord record = make_trial_record(0);
  set_state(record, 1, 2, UnitState::slip);
  set_state(record, 1, 3, UnitState::partial);
  set_state(record, 1, 4, UnitState::detached);
  run(dataset({record}), training);
  const auto table = table_of(path("out/press/demo_0-v_0.0-stop.csv"));
  ASSERT_THAT(table, SizeIs(rows));  // no header
  for (const auto& line : table) ASSERT_THAT(line, SizeIs(73));
  EXPECT_EQ(table[0][0], "0");
  EXPECT_EQ(table[1][0], "0.001");
  // Pillar p has columns 1 + 8 p: contact, slip, DX, DY, DZ [mm], FX, FY, FZ [N].
  EXPECT_THAT(std::vector<std::string>(table[1].begin() + 17, table[1].begin() + 19), ElementsAre("1", "1"));
  EXPECT_THAT(std::vector<std::string>(table[1].begin() + 25, table[1].begin() + 27), ElementsAre("1", "0"));
  EXPECT_THAT(std::vector<std::string>(table[1].begin() + 33, table[1].begin() + 35), ElementsAre("0", "0"));
  EXPECT_FLOAT_EQ(std::stof(table[1][1 + 8 * 2 + 2]), 0.002F);
  EXPECT_FLOAT_EQ(std::stof(table[1][1 + 8 * 2 + 4]), 0.001F);
  EXPECT_EQ(std::stof(table[1][1 + 8 * 2 + 5]), 0.1F * 2.0F);
  EXPECT_EQ(table[1][1 + 8 * 2 + 7], "1");
}

TEST_F(ExportTest, TheRuleChoosesTheFlag) {
  TrialRecord record = make_trial_record(0);
  set_state(record, 1, 0, UnitState::slip);
  set_state(record, 1, 1, UnitState::partial);
  // 0.3 and 0.4 mm/s give 0.5 mm/s, above the default threshold of 0.1 mm/s.
  record.sensors[0].labels.slip_velocity[(1 * pillars + 2) * 2] = 3e-4F;
  record.sensors[0].labels.slip_velocity[(1 * pillars + 2) * 2 + 1] = 4e-4F;
  const std::string from = dataset({record});
  const auto flags = [&](ExportOptions options) {
    run(from, options);
    const auto line = table_of(path("out/press/demo_0-v_0.0-stop.csv"))[1];
    return line[2] + line[10] + line[18];
  };
  ExportOptions options = training;
  EXPECT_EQ(flags(options), "100");
  options.slip_rule = LabelRule::micro;
  EXPECT_EQ(flags(options), "110");
  options.slip_rule = LabelRule::paper;
  EXPECT_EQ(flags(options), "001");
  options.slip_rule = LabelRule::has_slipped;
  EXPECT_EQ(flags(options), "001");
  options.label_speed = 6e-4;
  EXPECT_EQ(flags(options), "000");
  options.slip_rule = LabelRule::paper;
  EXPECT_EQ(flags(options), "000");
}

// Two pillars in contact, P0 and the centre P4, whose tips move at 0.2 mm/s in one sample each:
//   row   0          1          2        3         4        5          6        7
//   P0    stick      fast       stick    detached  stick    stick      fast     detached
//   P4    stick      stick      stick    stick     stick    fast       stick    detached
// P0 counts in rows 1 and 2, and from 6 on; its contact of row 4 is a new one. P4 counts from 5 on.
TEST(HasSlipped, CountsUntilContactIsLost) {
  SensorRecord record = make_sensor("pad", 1000.0, 8);
  LabelRecord& labels = record.labels;
  const auto state = [&](std::size_t row, std::size_t pillar) -> std::uint8_t& {
    return labels.unit_state[row * pillars + pillar];
  };
  std::fill(labels.unit_state.begin(), labels.unit_state.end(), static_cast<std::uint8_t>(UnitState::detached));
  for (std::size_t row = 0; row < 7; ++row) state(row, 0) = state(row, 4) = static_cast<std::uint8_t>(UnitState::stick);
  state(3, 0) = static_cast<std::uint8_t>(UnitState::detached);
  for (const std::size_t place : {1 * pillars, 5 * pillars + 4, 6 * pillars}) labels.slip_velocity[2 * place + 1] = -2e-4F;

  using enum PadState;
  const std::vector<PadState> has_slipped{non_slip, incipient, incipient, non_slip, non_slip, incipient, gross, no_contact};
  // Without the centre pillar, the only one in contact in row 3, so none is judged there.
  const std::vector<PadState> turning{non_slip, gross, gross, non_slip, non_slip, non_slip, gross, no_contact};
  const std::vector<PadState> now{non_slip, incipient, non_slip, non_slip, non_slip, incipient, incipient, no_contact};
  const PapillarraySamples samples(record, LabelRule::has_slipped, default_label_speed);
  const PapillarraySamples paper(record, LabelRule::paper, default_label_speed);
  const PapillarraySamples slower(record, LabelRule::has_slipped, 3e-4);  // a threshold that is never reached
  for (std::size_t row = 0; row < 8; ++row) {
    EXPECT_EQ(samples.pad_state(row, false), has_slipped[row]) << row;
    EXPECT_EQ(samples.pad_state(row, true), turning[row]) << row;
    EXPECT_EQ(paper.pad_state(row, false), now[row]) << row;
    EXPECT_EQ(slower.pad_state(row, false), row < 7 ? non_slip : no_contact) << row;
  }
}

// A record with `samples` at 1 kHz, where the pad moves sideways at `speed` and turns at `rotation`
// from row `start` on for `moving` rows, with all pillars in `state` in these rows.
TrialRecord moving_record(std::size_t trial, const std::string& params, float speed, float rotation, std::size_t start,
                          std::size_t moving, UnitState state) {
  constexpr std::size_t samples = 400;
  TrialRecord record;
  record.trial = trial;
  record.params = params;
  record.sensors.push_back(make_sensor("pad", 1000.0, samples));
  record.body_time = record.sensors[0].time;
  BodyRecord pad{"pad", std::vector<float>(samples * 7), std::vector<float>(samples * 6)};
  for (std::size_t row = start; row < start + moving; ++row) {
    pad.velocity[6 * row] = speed;
    pad.velocity[6 * row + 5] = rotation;
  }
  record.bodies.push_back(std::move(pad));
  record.sensors[0].labels.unit_state.assign(samples * pillars, static_cast<std::uint8_t>(state));
  return record;
}

// The name has the commanded speed, and "stop" if the pad halted soon after its start, for any
// slip.
TEST_F(ExportTest, TrainingFilesAreNamedByTheirMove) {
  const auto params = [](double speed, double rotation) {
    return "{\"motion.speed\": " + std::to_string(speed) + ", \"motion.rotation\": " + std::to_string(rotation) + "}";
  };
  const std::vector<TrialRecord> records{// Halts 50 ms and 100 ms after its start; all pillars slip.
                                         moving_record(0, params(4e-3, 0.0), 4e-3F, 0.0F, 100, 50, UnitState::slip),
                                         moving_record(1, params(1e-3, 0.0), 1e-3F, 0.0F, 100, 100, UnitState::slip),
                                         // To the end at 0.5 mm/s, without gross slip.
                                         moving_record(2, params(5e-4, 0.0), 5e-4F, 0.0F, 100, 300, UnitState::stick),
                                         // 0.4 rad/s at 9.9 mm: 3.96 mm/s.
                                         moving_record(3, params(0.0, -0.4), 0.0F, -0.4F, 100, 300, UnitState::stick),
                                         // A halt after half a second would not be a "stop" of the
                                         // protocol; here it is 200 ms.
                                         moving_record(4, params(8e-3, 0.4), 8e-3F, 0.4F, 100, 200, UnitState::stick),
                                         // The recording ends 50 ms after the start, and nothing
                                         // has braked.
                                         moving_record(5, params(4e-3, 0.0), 4e-3F, 0.0F, 350, 50, UnitState::slip),
                                         // Commanded to move after the recording's end: a press.
                                         moving_record(6, params(4e-3, 0.0), 0.0F, 0.0F, 0, 0, UnitState::stick)};
  EXPECT_THAT(run(dataset(records), training),
              ElementsAre(path("out/translation/demo_0-v_4.0-stop.csv"), path("out/translation/demo_1-v_1.0-stop.csv"),
                          path("out/translation/demo_2-v_0.5-slip.csv"), path("out/rotation/demo_3-v_4.0-slip.csv"),
                          path("out/combined/demo_4-v_8.0-slip.csv"), path("out/translation/demo_5-v_4.0-slip.csv"),
                          path("out/press/demo_6-v_0.0-stop.csv")));
}

// A pad that brakes before it reaches its speed: 50 mm/s2 for 50 ms up and 50 ms down, commanded 16
// mm/s and 50 ms.
TEST_F(ExportTest, SpeedIsTheCommandedOne) {
  TrialRecord record = moving_record(0, R"({"motion.speed": 0.016})", 0.0F, 0.0F, 0, 0, UnitState::stick);
  for (std::size_t row = 0; row <= 100; ++row) {
    record.bodies[0].velocity[6 * (100 + row)] = 5e-5F * static_cast<float>(std::min<std::size_t>(row, 100 - row));
  }
  EXPECT_THAT(run(dataset({record}), training), ElementsAre(path("out/translation/demo_0-v_16.0-stop.csv")));
}

TEST_F(ExportTest, SpeedComesFromTheSceneWhereItIsNotSwept) {
  const TrialRecord record = moving_record(0, "{}", 2e-3F, 0.0F, 100, 300, UnitState::stick);
  EXPECT_THAT(run(dataset({record}), training), ElementsAre(path("out/translation/demo_0-v_4.0-slip.csv")));  // default 4 mm/s
  scene_text = "slipbench: 1\nmotion: {speed: 1.25 mm/s}\n";
  EXPECT_THAT(run(dataset({record}), training), ElementsAre(path("out/translation/demo_0-v_1.25-slip.csv")));
  overrides = R"({"motion.speed": "2 mm/s"})";
  EXPECT_THAT(run(dataset({record}), training), ElementsAre(path("out/translation/demo_0-v_2.0-slip.csv")));
  // In their order, as `run` applies them.
  overrides = R"({"motion.speed": "8 mm/s", "motion": "{speed: 3 mm/s}", "sweep.motion.speed": "[5 mm/s]", "seed": "8"})";
  EXPECT_THAT(run(dataset({record}), training), ElementsAre(path("out/translation/demo_0-v_3.0-slip.csv")));
  overrides = R"({"motion.speed": "2 mm"})";
  EXPECT_THAT(refusal_of([&] { run(dataset({record}), training); }), HasSubstr("--set motion.speed"));
  overrides = "{}";
  scene_text = "slipbench: 1\nmotion: {kind: orbit}\n";
  EXPECT_THAT(refusal_of([&] { run(dataset({record}), training); }), HasSubstr("motion 'orbit'"));
}

TEST_F(ExportTest, LabelSpeedNeedsTheRuleThatHasIt) {
  ExportOptions options = vendor;
  options.label_speed = 2e-4;
  EXPECT_THAT(refusal_of([&] { run(dataset({make_trial_record(0)}), options); }), mentions({"--labels", "paper", "has_slipped"}));
  EXPECT_FALSE(std::filesystem::exists(path("out")));
  options.slip_rule = LabelRule::paper;
  EXPECT_THAT(run(path("a.h5"), options), SizeIs(1));
}

TEST_F(ExportTest, InputIsNeverReplaced) {
  const std::string from = dataset({make_trial_record(0)});
  const std::string before = bytes_of(from);
  ::mkdir(path("out").c_str(), 0777);
  for (const char* name : {"out/LOG_demo_0.csv", "out/LOG_demo_0.csv.partial"}) {
    std::filesystem::rename(from, path(name));
    EXPECT_THAT(refusal_of([&] { run(path(name), vendor); }), mentions({"input"}));
    EXPECT_EQ(bytes_of(path(name)), before);
    std::filesystem::rename(path(name), from);
  }
}

// Earlier exports are replaced; the user's own files are not.
TEST_F(ExportTest, ReplacesItsOwnFilesAndNothingElse) {
  const std::string from = dataset({make_trial_record(0)});
  const std::vector<std::pair<ExportOptions, std::string>> cases{{vendor, "out/LOG_demo_0.csv"},
                                                                 {training, "out/press/demo_0-v_0.0-stop.csv"}};
  for (const auto& [options, name] : cases) {
    run(from, options);
    const std::string whole = bytes_of(path(name));
    EXPECT_NO_THROW(run(from, options));
    for (const std::string& target : {path(name), path(name + ".partial")}) {
      for (const char* text : {"time,force\n0,1\n", "my notes\n"}) {
        std::ofstream(target, std::ios::trunc) << text;
        EXPECT_THAT(refusal_of([&] { run(from, options); }), mentions({target, "exists"}));
        EXPECT_EQ(bytes_of(target), text);
      }
      std::ofstream(target, std::ios::trunc) << whole;  // as a killed export leaves it
    }
    EXPECT_NO_THROW(run(from, options));
  }
}

// The export contains what was written, or nothing, even if only another trial of the file is
// changed.
TEST_F(ExportTest, ChangedArraysAreRefused) {
  EncodedTrial changed = TrialEncoder().encode(make_trial_record(1));
  changed.digest[0] ^= 1U;
  DatasetWriter writer(path("a.h5"), {"1", scene_text, overrides, 7, "slipbench sweep a.yaml"});
  writer.append(TrialEncoder().encode(make_trial_record(0)));
  writer.append(changed);
  writer.commit();
  ExportOptions first = vendor;
  first.trial = 0;
  for (const ExportOptions& options : {vendor, training, first}) {
    EXPECT_THAT(refusal_of([&] { run(path("a.h5"), options); }), mentions({"a.h5", "SHA-256"}));
    EXPECT_FALSE(std::filesystem::exists(path("out")));
  }
}

// A damaged file is exported or refused, never ended by a signal.
TEST_F(ExportTest, DamagedDatasetsAreExportedOrRefused) {
  const std::string whole = bytes_of(dataset({make_trial_record(0)}));
  std::size_t refused = 0;
  for (std::size_t step = 0; step < 300; ++step) {
    std::string bytes = whole;
    bytes[(step * 7919) % whole.size()] ^= static_cast<char>(1 + (step * 31) % 255);
    std::ofstream(path("damaged.h5"), std::ios::binary | std::ios::trunc) << bytes;
    refused += refusal_of([&] { run(path("damaged.h5"), training); }) != "accepted" ? 1 : 0;
  }
  EXPECT_GE(refused, 30U);
}

TEST_F(ExportTest, OneTrialCanBeChosen) {
  ExportOptions options = vendor;
  options.trial = 1;
  EXPECT_THAT(run(dataset({make_trial_record(0), make_trial_record(1)}), options), ElementsAre(path("out/LOG_demo_1.csv")));
  options.trial = 5;
  EXPECT_THAT(refusal_of([&] { run(path("a.h5"), options); }), mentions({"trial 5"}));
}

TEST_F(ExportTest, WhatDoesNotFitIsRefused) {
  EXPECT_THAT(refusal_of([&] { run(dataset({make_trial_record(0, 500.0)}), training); }), mentions({"1000 Hz", "500 Hz"}));
  TrialRecord two = make_trial_record(0);
  two.sensors.push_back(make_sensor("second", 1000.0));
  EXPECT_THAT(refusal_of([&] { run(dataset({two}), training); }), mentions({"pad", "second"}));
  ExportOptions second = training;
  second.sensors = {"second"};
  EXPECT_THAT(run(dataset({two}), second), SizeIs(1));
  TrialRecord other = make_trial_record(0);
  other.sensors[0].type = "nose";
  EXPECT_THAT(refusal_of([&] { run(dataset({other}), vendor); }), mentions({"papillarray"}));
  EXPECT_THAT(refusal_of([&] { run(dataset({}), vendor); }), mentions({"no trial"}));
}

TEST_F(ExportTest, UnusableFoldersAreRefused) {
  const std::string from = dataset({make_trial_record(0)});
  EXPECT_THAT(refusal_of([&] { export_dataset(from, path("no/out"), vendor); }), HasSubstr("No such file or directory"));
  std::ofstream(path("file")) << "x";
  EXPECT_THAT(refusal_of([&] { export_dataset(from, path("file"), vendor); }), mentions({"File exists", "folder"}));
}

TEST_F(ExportTest, FullDiskLeavesNoHalfFile) {
  const std::string from = dataset({make_trial_record(0)});
  ::mkdir(path("out").c_str(), 0777);
  const int status = in_child([&] {
    const rlimit limits{100, 100};
    ::setrlimit(RLIMIT_FSIZE, &limits);
    std::signal(SIGXFSZ, SIG_IGN);
    const std::string refusal = refusal_of([&] { run(from, vendor); });
    ::_exit(refusal == "cannot write " + path("out/LOG_demo_0.csv") + ": File too large" ? 0 : 2);
  });
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(std::filesystem::is_empty(path("out")));
}

TEST(ExportNames, AreParsedWithTheNearestName) {
  EXPECT_EQ(parse_export_format("training-csv"), ExportFormat::training_csv);
  EXPECT_THAT(refusal_of([] { parse_export_format("vendor_csv"); }), mentions({"vendor_csv", "vendor-csv"}));
}

}  // namespace
}  // namespace slipbench::testing
