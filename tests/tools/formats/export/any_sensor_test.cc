// Formats for any sensor: columns, archives, refusals and leftovers.
#include <filesystem>
#include <fstream>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/formats/export/export.h"
#include "tools/formats/export/formats.h"
#include "tools/learning_data/samples.h"

namespace slipbench::any_sensor_test {
namespace {

using slipbench::testing::make_grasp_record;
using slipbench::testing::make_record;
using ::testing::Ge;
using ::testing::Le;

// A multiplexed pad at 300 Hz: FL and FR in every sample, one value of SI in every third, read
// 2/300 s earlier.
SensorRecord nib_pad(std::size_t rows) {
  SensorRecord sensor = make_record(0, rows).sensors[0];
  sensor.name = "nib";
  sensor.type = "nib_pad";
  sensor.rate = 300.0;
  sensor.channel_names = {"SI_0", "FL_N", "FL_S", "FR_plus", "FR_minus"};
  sensor.channels = {{"si", "1", {1}, {}, std::vector<double>{}}, {"fl", "1", {2}, {}}, {"fr", "1", {2}, {}}};
  for (std::size_t row = 0; row < rows; ++row) {
    const auto value = static_cast<float>(row);
    sensor.time[row] = static_cast<double>(row + 1) / 300.0;
    sensor.channels[1].values.insert(sensor.channels[1].values.end(), {7000.0F + 3.0F * value, 7000.0F + value});
    sensor.channels[2].values.insert(sensor.channels[2].values.end(), {6000.0F, 6000.0F + value});
    sensor.labels.state[row] = static_cast<std::uint8_t>(row % 4);
    if (row % 3 != 2) continue;
    sensor.channels[0].values.push_back(value);
    sensor.channels[0].time->push_back(sensor.time[row] - 2.0 / 300.0);
  }
  return sensor;
}

struct AnySensor : slipbench::testing::FolderTest {
  std::string dataset(const std::vector<TrialRecord>& records, const std::string& name = "a.h5") {
    return slipbench::testing::write_dataset(path(name), {"1", "slipbench: 1\n", "{}", 7, "slipbench sweep a.yaml"}, records);
  }
  std::vector<std::string> run(ExportFormat format, const std::string& sensor = "", std::optional<double> rate = {},
                               const std::string& out = "out") {
    ExportOptions options;
    options.format = format;
    options.rate = rate;
    if (!sensor.empty()) options.sensors = {sensor};
    return export_dataset(path("a.h5"), path(out), options);
  }
};

// FL = N - S = 7000 + 3 r - (7000 + r) = 2 r, FR = 6000 - (6000 + r) = -r.
TEST(TableCsv, FormsThePapersDifferences) {
  const std::vector<CsvTable> tables = table_csv(nib_pad(4));
  ASSERT_THAT(tables, SizeIs(2));
  const std::vector<std::string> lines = lines_of(tables[0].text);
  ASSERT_THAT(lines, SizeIs(5));
  EXPECT_EQ(lines[0], "t [s],FL [1],FL_N [1],FL_S [1],FR [1],FR_plus [1],FR_minus [1],state,state_micro,state_paper");
  EXPECT_EQ(lines[3], "0.01,4,7006,7002,-2,6000,6002,2,3,1");
}

// A channel with its own times gets its own table. Its row was read at 1/300 s, when the state was
// that of sample 0.
TEST(TableCsv, SlowChannelsKeepTheirTime) {
  const std::vector<CsvTable> tables = table_csv(nib_pad(4));
  EXPECT_EQ(tables[1].channel, "si");
  const std::vector<std::string> lines = lines_of(tables[1].text);
  ASSERT_THAT(lines, SizeIs(2));
  EXPECT_EQ(lines[0], "t [s],SI_0 [1],state,state_micro,state_paper");
  EXPECT_THAT(lines[1], HasSubstr(",2,0,3,1"));
  EXPECT_NEAR(std::stod(lines[1]), 1.0 / 300.0, 1e-15);
}

TEST(TableCsv, NamesMustFitTheValues) {
  SensorRecord sensor = nib_pad(4);
  sensor.channel_names.pop_back();
  EXPECT_THAT(refusal_of([&] { table_csv(sensor); }), refused_at("sensor nib", {"4 names", "5 values"}));
  sensor = nib_pad(4);
  sensor.channel_names = {"SI_0", "FL", "FR_plus", "FR_minus"};
  sensor.channels[1].shape = {1};
  EXPECT_THAT(refusal_of([&] { table_csv(sensor); }), refused_at("sensor nib", {"fl", "1", "2"}));
}

TEST_F(AnySensor, LabelsAndSplitsLeaveTheirPart) {
  const auto [from, reader] = [&] {
    const std::string file = dataset({make_record(0, 4), make_record(1, 4), make_record(2, 4), make_record(3, 4)});
    return std::pair{file, DatasetReader(file)};
  }();
  ExportOptions options;
  options.format = ExportFormat::csv;
  options.slip_rule = LabelRule::micro;
  options.split = "test";
  std::vector<std::string> expected;
  for (const std::size_t trial : reader.mask("test")) expected.push_back(path(fmt::format("out/demo_{}-pad.csv", trial)));
  ASSERT_THAT(expected, SizeIs(AllOf(Ge(1U), Le(3U))));
  EXPECT_EQ(export_dataset(from, path("out"), options), expected);
  const std::string header = lines_of(bytes_of(expected.front())).front();
  EXPECT_THAT(header, EndsWith(",state_micro"));
  EXPECT_THAT(header, Not(HasSubstr(",state,")));
  options.slip_rule = LabelRule::has_slipped;
  EXPECT_THAT(refusal_of([&] { export_dataset(from, path("no"), options); }), mentions({"csv", "has_slipped", "--labels"}));
  options.slip_rule = {};
  options.split = "tests";
  EXPECT_THAT(refusal_of([&] { export_dataset(from, path("no"), options); }), mentions({"test"}));
  options.split = "test";
  options.trial = reader.mask("train").front();
  EXPECT_THAT(refusal_of([&] { export_dataset(from, path("no"), options); }), mentions({"test", "no trial"}));
}

TEST_F(AnySensor, TablesAreNamedByTrialAndSensor) {
  TrialRecord record = make_record(2, 6);
  record.sensors.push_back(nib_pad(6));
  dataset({record});
  EXPECT_THAT(run(ExportFormat::csv),
              ElementsAre(path("out/demo_2-nib.csv"), path("out/demo_2-nib-si.csv"), path("out/demo_2-pad.csv")));
  // 2 + 0.001 i in one channel's ramp, 102 + 0.001 i in the other.
  EXPECT_EQ(lines_of(bytes_of(path("out/demo_2-pad.csv")))[2], "0.001,2.002,2.003,102.001,2,3,1");
  EXPECT_THAT(run(ExportFormat::csv, "nib"), SizeIs(2));  // replaces its own files
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::csv, "nip", {}, "other"); }), refused_at("trial 2", {"nip", "nib"}));
  EXPECT_FALSE(std::filesystem::exists(path("other")));
}

// The header of version 1.0: magic, version, length, a Python literal, padded with spaces to a
// multiple of 64 bytes.
TEST(Npz, HeaderIsNumpys) {
  const std::string header = npy_header("<f4", {5, 9, 3});
  EXPECT_EQ(header.size() % 64, 0U);
  EXPECT_EQ(header.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_EQ(static_cast<std::size_t>(static_cast<unsigned char>(header[8])), header.size() - 10);
  EXPECT_EQ(header[9], '\0');
  EXPECT_THAT(header, HasSubstr("{'descr': '<f4', 'fortran_order': False, 'shape': (5,9,3,), }"));
  EXPECT_EQ(header.back(), '\n');
  EXPECT_THAT(npy_header("<f8", {}), HasSubstr("'shape': (), }"));
}

TEST_F(AnySensor, ArchivesRepeatToTheByte) {
  dataset({make_grasp_record(0, 5)});
  EXPECT_THAT(run(ExportFormat::npz), ElementsAre(path("out/demo_0.npz")));
  const std::string first = bytes_of(path("out/demo_0.npz"));
  run(ExportFormat::npz, "", {}, "again");
  EXPECT_EQ(bytes_of(path("again/demo_0.npz")), first);
  EXPECT_TRUE(begins_as_npz(first));
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::grasp_csv, "pad"); }), mentions({"grasp-csv", "ff", "mf", "th", "--sensors"}));
}

TEST(LatestRow, IsTheOneAtOrBefore) {
  const std::vector<double> times{1.0 / 300.0, 2.0 / 300.0, 3.0 / 300.0};
  EXPECT_EQ(latest_row(times, 0.0033), std::nullopt);
  EXPECT_EQ(latest_row(times, 0.01), 2U);  // 3/300, despite rounding
  EXPECT_EQ(latest_row(times, 0.0099), 1U);
  EXPECT_EQ(latest_row(times, 1.0), 2U);
}

// A pad at 1 kHz that reads 0 ... 10 in 11 samples, and moves at (row, 0, -2 row) mm/s while it
// turns at -row rad/s.
TrialRecord moving_pad(std::size_t trial) {
  constexpr std::size_t rows = 11;
  TrialRecord record = make_record(trial, rows);
  for (std::size_t row = 0; row < rows; ++row) {
    const auto value = static_cast<float>(row);
    record.sensors[0].channels[1].values[row] = value;
    record.sensors[0].labels.state[row] = row < 5 ? 1 : 3;
    const std::array<float, 6> velocity{1e-3F * value, 0.0F, -2e-3F * value, 0.0F, 0.0F, -value};
    std::copy(velocity.begin(), velocity.end(), record.bodies[0].velocity.begin() + static_cast<std::ptrdiff_t>(6 * row));
  }
  return record;
}

// At 250 Hz every fourth sample: 0, 4, 8 ms, two steps. The largest components in the recordings
// are 20 mm/s and 10 rad/s.
TEST_F(AnySensor, EpisodesTakeTheLatestSample) {
  dataset({moving_pad(0)});
  const DatasetReader reader(path("a.h5"));
  const ActionSpace space = action_space(reader, {0});
  EXPECT_THAT(space.bodies, ElementsAre("pad"));
  EXPECT_THAT(space.names, ElementsAre("pad_vx", "pad_vy", "pad_vz", "pad_wx", "pad_wy", "pad_wz"));
  EXPECT_FLOAT_EQ(static_cast<float>(space.scale[0]), 0.02F);
  EXPECT_FLOAT_EQ(static_cast<float>(space.scale[5]), 10.0F);
  const Episode episode = make_episode(reader, 0, {}, 250.0, space);
  EXPECT_EQ(episode.steps, 2U);
  ASSERT_THAT(episode.observations, SizeIs(2));
  EXPECT_EQ(episode.observations[0].name, "pad_force");
  EXPECT_EQ(episode.observations[0].width, 2U);
  EXPECT_THAT(episode.observations[1].values, ElementsAre(0.0F, 4.0F, 8.0F));  // including the one after the last step
  EXPECT_THAT(episode.states[0].values, ElementsAre(1.0F, 1.0F));              // at 0 and 4 ms
  EXPECT_FLOAT_EQ(episode.actions.values[6 + 0], 0.2F);                        // 4 of 20 mm/s
  EXPECT_FLOAT_EQ(episode.actions.values[6 + 2], -0.4F);
  EXPECT_FLOAT_EQ(episode.actions.values[6 + 5], -0.4F);  // 4 of 10 rad/s
  EXPECT_EQ(episode.bodies.width, 13U);
  EXPECT_FLOAT_EQ(episode.bodies.values[13 + 7], 4e-3F);  // after the pose of row 4
  EXPECT_THAT(episode.rewards, ElementsAre(0.0F, 0.0F));
  EXPECT_EQ(slowest_rate(reader, 0, {}), 1000.0);
}

// Registers 0 to 255 become -1 to 1; a box held to the end gives the reward 1.
TEST_F(AnySensor, GraspsActByTheirCommands) {
  TrialRecord held = make_grasp_record(0, 5);
  held.outcome.grasp->dropped = false;
  dataset({held, make_grasp_record(1, 5)});
  const DatasetReader reader(path("a.h5"));
  const ActionSpace space = action_space(reader, {0, 1});
  const Episode episode = make_episode(reader, 0, {}, 1000.0, space);
  EXPECT_EQ(episode.actions.width, 3U);
  EXPECT_FLOAT_EQ(episode.actions.values[3 * 2 + 1], static_cast<float>((3.0 - 127.5) / 127.5));  // row 2: registers 2, 3, 4
  EXPECT_EQ(episode.observations.back().name, "gripper_position");
  EXPECT_THAT(episode.observations.back().values, ElementsAre(3.0F, 4.0F, 5.0F, 6.0F, 7.0F));
  EXPECT_THAT(episode.rewards, ElementsAre(0.0F, 0.0F, 0.0F, 1.0F));
  EXPECT_EQ(make_episode(reader, 1, {}, 1000.0, space).rewards.back(), 0.0F);  // dropped
}

// A slow channel holds its value, and the demonstration begins when everything has been read once:
// SI at 1/300 s, the body at 0.
TEST_F(AnySensor, EpisodesHoldSlowChannels) {
  TrialRecord record = make_record(0, 40);
  record.sensors = {nib_pad(9)};
  dataset({record});
  const DatasetReader reader(path("a.h5"));
  const Episode episode = make_episode(reader, 0, {"nib"}, 300.0, action_space(reader, {0}));
  EXPECT_THAT(episode.observations[0].values, ElementsAre(2.0F, 2.0F, 2.0F, 5.0F, 5.0F, 5.0F, 8.0F, 8.0F, 8.0F));
  EXPECT_EQ(episode.steps, 8U);
}

// Two sensors on one contact, 1 kHz and 300 Hz: an archive keeps each at its own times, a
// demonstration holds the latest values at the slower rate from 1/300 s on. Row r of the pad is its
// sample at or before (r + 1)/300 s: 3, 6, 10, 13 ms.
TEST_F(AnySensor, SensorsOfDifferentRatesShareADemonstration) {
  TrialRecord record = make_record(0, 16);
  record.sensors[0].rate = 1000.0;
  for (std::size_t row = 0; row < 16; ++row) record.sensors[0].channels[1].values[row] = static_cast<float>(row);
  record.sensors.push_back(nib_pad(4));
  dataset({record});
  const DatasetReader reader(path("a.h5"));
  EXPECT_EQ(slowest_rate(reader, 0, {}), 300.0);
  const Episode episode = make_episode(reader, 0, {}, 300.0, action_space(reader, {0}));
  EXPECT_EQ(episode.steps, 3U);
  ASSERT_THAT(episode.observations, SizeIs(5));
  EXPECT_EQ(episode.observations[4].name, "pad_displacement");  // sensors in the order of their names
  EXPECT_THAT(episode.observations[4].values, ElementsAre(3.0F, 6.0F, 10.0F, 13.0F));
  EXPECT_EQ(episode.observations[1].name, "nib_fl");
  EXPECT_THAT(episode.observations[1].values, ElementsAre(7000, 7000, 7003, 7001, 7006, 7002, 7009, 7003));
  const std::string archive = bytes_of(run(ExportFormat::npz).front());
  for (const char* key : {"sensors/pad/t.npy", "sensors/nib/t.npy", "labels/pad/state.npy", "labels/nib/state.npy"}) {
    EXPECT_THAT(archive, HasSubstr(key));
  }
}

TEST_F(AnySensor, DemonstrationsRepeatToTheByteAndReplaceTheirOwn) {
  dataset({moving_pad(0), moving_pad(1), moving_pad(2)});
  EXPECT_THAT(run(ExportFormat::robomimic), ElementsAre(path("out/robomimic.hdf5")));
  const std::string first = bytes_of(path("out/robomimic.hdf5"));
  run(ExportFormat::robomimic);
  EXPECT_EQ(bytes_of(path("out/robomimic.hdf5")), first);
  EXPECT_THAT(names(), ElementsAre("a.h5", "out"));
  EXPECT_FALSE(std::filesystem::exists(path("out/robomimic.hdf5.partial")));

  for (const std::string& target : {path("out/robomimic.hdf5"), path("out/robomimic.hdf5.partial")}) {
    std::filesystem::copy_file(path("a.h5"), target,
                               std::filesystem::copy_options::overwrite_existing);  // a dataset is not an export
    EXPECT_THAT(refusal_of([&] { run(ExportFormat::robomimic); }), mentions({target, "robomimic"}));
    EXPECT_EQ(bytes_of(target), bytes_of(path("a.h5")));
    std::filesystem::remove(target);
  }
}

// A killed export leaves truncated HDF5 under its temporary name.
TEST_F(AnySensor, DemonstrationsReplaceWhatAKilledRunLeft) {
  dataset({moving_pad(0), moving_pad(1)});
  run(ExportFormat::robomimic);
  const std::string whole = bytes_of(path("out/robomimic.hdf5"));
  const std::string left = path("out/robomimic.hdf5.partial");
  for (const std::string& beginning : {whole, whole.substr(0, whole.size() / 2), whole.substr(0, 100), std::string()}) {
    std::ofstream(left, std::ios::binary) << beginning;
    run(ExportFormat::robomimic);
    EXPECT_EQ(bytes_of(path("out/robomimic.hdf5")), whole) << beginning.size();
    EXPECT_FALSE(std::filesystem::exists(left)) << beginning.size();
  }
  // Under its own name a file is never half-written, so an unreadable one is foreign; so is a text
  // under the temporary name.
  std::ofstream(path("out/robomimic.hdf5"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::robomimic); }), mentions({"robomimic"}));
  std::filesystem::remove(path("out/robomimic.hdf5"));
  std::ofstream(left, std::ios::binary) << "notes";
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::robomimic); }), mentions({left, "robomimic"}));
}

// Files that another run has written so far are left for it to finish.
TEST_F(AnySensor, DemonstrationsThatAnotherRunIsWritingAreLeftToIt) {
  dataset({moving_pad(0)});
  run(ExportFormat::robomimic);
  const std::string whole = bytes_of(path("out/robomimic.hdf5"));
  const std::string other = path("out/robomimic.hdf5.partial");
  for (const std::string& beginning : {whole, whole.substr(0, whole.size() / 2), std::string()}) {
    std::ofstream(other, std::ios::binary) << beginning;
    const int locked = ::open(other.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::flock(locked, LOCK_EX | LOCK_NB), 0);
    EXPECT_THAT(refusal_of([&] { run(ExportFormat::robomimic); }), mentions({other, "another run"}));
    ::close(locked);
    EXPECT_TRUE(std::filesystem::exists(other)) << beginning.size();
    EXPECT_EQ(bytes_of(other), beginning) << beginning.size();
    EXPECT_EQ(bytes_of(path("out/robomimic.hdf5")), whole) << beginning.size();
  }
  run(ExportFormat::robomimic);  // the other run has ended
  EXPECT_FALSE(std::filesystem::exists(other));
}

TEST_F(AnySensor, RatesMustFit) {
  dataset({moving_pad(0)});
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::robomimic, "", 2000.0); }), mentions({"2000 Hz", "1000 Hz"}));
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::robomimic, "", 10.0); }), refused_at("trial 0", {"10 Hz", "two samples"}));
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::npz, "", 1001.0); }), refused_at("trial 0", {"1001 Hz", "pad", "1000 Hz"}));
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::csv, "", 10.0); }), refused_at("trial 0", {"pad", "10 Hz", "--rate"}));
  EXPECT_THAT(refusal_of([&] { run(ExportFormat::training_csv, "", 500.0); }), mentions({"training-csv", "1000", "--rate"}));
  EXPECT_FALSE(std::filesystem::exists(path("out")));  // nothing is left behind
}

// SI and FL are first read at 1/300 s, the last sample is at 12/300 s: with 100 Hz there are rows
// at 1, 4, 7 and 10 of 300 s.
TEST(AtRate, TakesTheLatestOfEveryColumn) {
  const SensorRecord all = nib_pad(12);
  const SensorRecord taken = at_rate(all, 100.0, 0);
  ASSERT_THAT(taken.time, SizeIs(4));
  EXPECT_EQ(taken.rate, 100.0);
  for (std::size_t row = 0; row < 4; ++row) {
    const std::size_t from = 3 * row;  // counts from 0, and its time from 1/300 s
    EXPECT_NEAR(taken.time[row], all.time[from], 1e-12);
    EXPECT_EQ(taken.labels.state[row], all.labels.state[from]);
    EXPECT_EQ(taken.labels.slip_velocity[row * 2 * taken.labels.units()],
              all.labels.slip_velocity[from * 2 * all.labels.units()]);
    EXPECT_EQ(taken.channels[1].values[2 * row], all.channels[1].values[2 * from]);
  }
  // SI 2, 5, 8, 11 are read at 1, 4, 7, 10 of 300 s: each at its row.
  EXPECT_FALSE(taken.channels[0].time);
  EXPECT_THAT(taken.channels[0].values, ElementsAre(2.0F, 5.0F, 8.0F, 11.0F));
  EXPECT_EQ(taken.labels.event_time, all.labels.event_time);
}

TEST_F(AnySensor, TablesAndArchivesTakeARate) {
  TrialRecord record = make_record(0, 6);
  record.sensors.push_back(nib_pad(6));
  dataset({record});
  EXPECT_THAT(run(ExportFormat::csv, "nib", 150.0), ElementsAre(path("out/demo_0-nib.csv")));  // including SI, which is held
  // Rows at 1, 3 and 5 of 300 s; SI is 2 from 1 and 5 from 4 of 300 s.
  const std::vector<std::string> lines = lines_of(bytes_of(path("out/demo_0-nib.csv")));
  ASSERT_THAT(lines, SizeIs(4));
  EXPECT_THAT(lines[2], HasSubstr(",2,"));
  EXPECT_THAT(lines[3], HasSubstr(",5,"));
  EXPECT_THAT(run(ExportFormat::npz, "nib"), ElementsAre(path("out/demo_0.npz")));
  EXPECT_THAT(bytes_of(path("out/demo_0.npz")), AllOf(HasSubstr("sensors/nib/fl.npy"), Not(HasSubstr("sensors/pad/"))));
}

TEST(Gzip, BringsTheTextBackAndRepeatsToTheByte) {
  EXPECT_EQ(beginning_of_gzip(gzip("")), "");
  const std::string text = "0.001,2.002\n0.002,2.003\n";
  EXPECT_EQ(beginning_of_gzip(gzip(text)), text);
  EXPECT_EQ(gzip(text), gzip(text));
  std::string much;
  for (int i = 0; i < 100000; ++i) much += fmt::format("{}\n", i);
  const std::string packed = gzip(much);
  EXPECT_LT(packed.size(), much.size() / 2);
  EXPECT_EQ(beginning_of_gzip(packed.substr(0, 4096)).substr(0, 20), much.substr(0, 20));  // as far as the file's beginning shows
  EXPECT_EQ(beginning_of_gzip("my notes"), "");
}

TEST_F(AnySensor, CompressedTablesReplaceTheirOwn) {
  dataset({make_record(0, 6)});
  ExportOptions options;
  options.format = ExportFormat::csv;
  run(options.format);
  options.compress = true;
  for (int times = 0; times < 2; ++times) {
    EXPECT_THAT(export_dataset(path("a.h5"), path("out"), options), ElementsAre(path("out/demo_0-pad.csv.gz")));
    EXPECT_EQ(beginning_of_gzip(bytes_of(path("out/demo_0-pad.csv.gz"))), bytes_of(path("out/demo_0-pad.csv")));
  }
  std::ofstream(path("out/demo_0-pad.csv.gz")) << gzip("my notes");
  EXPECT_THAT(refusal_of([&] { export_dataset(path("a.h5"), path("out"), options); }), mentions({"exists"}));
  options.format = ExportFormat::npz;
  EXPECT_THAT(refusal_of([&] { export_dataset(path("a.h5"), path("out"), options); }),
              mentions({"npz", "--compress", "robomimic"}));
}

// Before the second of several trials their total bytes are known, in every format.
TEST_F(AnySensor, EveryFormatTellsItsBytes) {
  dataset({moving_pad(0), moving_pad(1)});
  for (const ExportFormat format : {ExportFormat::csv, ExportFormat::npz, ExportFormat::robomimic}) {
    ExportOptions options;
    options.format = format;
    const std::string progress_file = path("progress");  // written by the child process
    export_dataset(path("a.h5"), path("out"), options, [&](std::size_t done, std::size_t total, std::uintmax_t bytes) {
      std::ofstream(progress_file, done == 1 ? std::ios::trunc : std::ios::app)
          << fmt::format("{}/{} {}\n", done, total, bytes > 0);
    });
    EXPECT_EQ(bytes_of(progress_file), "1/2 true\n2/2 true\n");
  }
}

// Only the outcome of trial 1 was recorded: nothing is written in any format, not even trial 0.
TEST_F(AnySensor, TrialsWithoutARecordingAreRefused) {
  TrialRecord outcome;
  outcome.trial = 1;
  outcome.seed = 7;
  dataset({make_record(0, 6), outcome});
  for (const ExportFormat format : {ExportFormat::csv, ExportFormat::npz, ExportFormat::robomimic, ExportFormat::vendor_csv}) {
    EXPECT_THAT(refusal_of([&] { run(format); }), mentions({"recording", "outcome"}));
    EXPECT_FALSE(std::filesystem::exists(path("out")));
  }
}

TEST_F(AnySensor, OtherFilesAreKept) {
  dataset({make_record(0, 6)});
  std::filesystem::create_directory(path("out"));
  for (const auto& [format, name] :
       {std::pair{ExportFormat::csv, "out/demo_0-pad.csv"}, std::pair{ExportFormat::npz, "out/demo_0.npz"}}) {
    std::ofstream(path(name)) << "t,force\n0,1\n";
    EXPECT_THAT(refusal_of([&] { run(format); }), mentions({"exists"}));
    EXPECT_EQ(bytes_of(path(name)), "t,force\n0,1\n");
  }
}

}  // namespace
}  // namespace slipbench::any_sensor_test
