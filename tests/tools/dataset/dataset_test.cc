#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <hdf5.h>

#include "tests/expect.h"
#include "tests/tools/dataset/record/test_records.h"
#include "tools/dataset/reader.h"
#include "tools/dataset/writer.h"

namespace slipbench::testing {
namespace {

const DatasetHeader header{"1.2.3", "slipbench: 1\ndescription: \xC2\xB5\n", R"({"motion.speed":"8 mm/s"})", 7,
                           "slipbench sweep a.yaml"};

// Two floats of the same bits: NaN equals NaN.
void expect_same(const std::vector<float>& found, const std::vector<float>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(float)), 0);
}

void expect_same(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_TRUE(found[i] == expected[i] || (std::isnan(found[i]) && std::isnan(expected[i])));
}

struct DatasetTest : FolderTest {
  std::string write(const std::string& name, std::size_t trials, std::size_t rows, std::uint64_t limit) {
    DatasetWriter writer(path(name), header, limit);
    for (std::size_t k = 0; k < trials; ++k) writer.append(make_trial(k, rows));
    writer.commit();
    return path(name);
  }
};

TEST_F(DatasetTest, ComesBackAsItWasWritten) {
  const DatasetReader reader(write("a.h5", 3, 40, DatasetWriter::default_shard_limit));
  EXPECT_EQ(reader.header().version, header.version);
  EXPECT_EQ(reader.header().scene, header.scene);
  EXPECT_EQ(reader.header().overrides, header.overrides);
  EXPECT_EQ(reader.header().seed, header.seed);
  EXPECT_EQ(reader.header().command, header.command);
  EXPECT_TRUE(reader.complete());
  EXPECT_THAT(reader.trials(), ElementsAre(0, 1, 2));

  const TrialRecord expected = make_record(2, 40);
  const TrialRecord found = reader.read_trial(2);
  EXPECT_EQ(found.seed, expected.seed);
  EXPECT_EQ(found.params, expected.params);
  EXPECT_EQ(found.outcome.touch_time, expected.outcome.touch_time);
  EXPECT_EQ(found.num_samples(), 40U);
  EXPECT_EQ(reader.info(2).num_samples, 40U);

  const SensorRecord& sensor = found.sensors.at(0);
  const SensorRecord& original = expected.sensors[0];
  EXPECT_EQ(sensor.name, original.name);
  EXPECT_EQ(sensor.type, original.type);
  EXPECT_EQ(reader.sensor_type(2, "pad"), original.type);
  EXPECT_EQ(sensor.rate, original.rate);
  EXPECT_EQ(sensor.frame, original.frame);
  EXPECT_EQ(sensor.channel_names, original.channel_names);
  expect_same(sensor.time, original.time);
  ASSERT_EQ(sensor.channels.size(), 2U);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(sensor.channels[c].name, original.channels[c].name);
    EXPECT_EQ(sensor.channels[c].unit, original.channels[c].unit);
    EXPECT_EQ(sensor.channels[c].shape, original.channels[c].shape);
    expect_same(sensor.channels[c].values, original.channels[c].values);
  }
  EXPECT_EQ(sensor.labels.unit_state, original.labels.unit_state);
  expect_same(sensor.labels.slip_velocity, original.labels.slip_velocity);
  expect_same(sensor.labels.slip_distance, original.labels.slip_distance);
  expect_same(sensor.labels.margin, original.labels.margin);
  expect_same(sensor.labels.force, original.labels.force);
  EXPECT_EQ(sensor.labels.state, original.labels.state);
  EXPECT_EQ(sensor.labels.state_micro, original.labels.state_micro);
  EXPECT_EQ(sensor.labels.state_paper, original.labels.state_paper);
  expect_same(sensor.labels.stuck_fraction, original.labels.stuck_fraction);
  expect_same(sensor.labels.slip_direction, original.labels.slip_direction);
  expect_same(sensor.labels.slip_centre, original.labels.slip_centre);
  expect_same(sensor.labels.slip_angle, original.labels.slip_angle);
  expect_same(sensor.labels.event_time, original.labels.event_time);
  EXPECT_EQ(sensor.labels.event_unit, original.labels.event_unit);
  EXPECT_EQ(sensor.labels.event_kind, original.labels.event_kind);
  expect_same(sensor.labels.unit_positions, original.labels.unit_positions);
  expect_same(sensor.labels.unit_heights, original.labels.unit_heights);
  expect_same(sensor.labels.k_normal, original.labels.k_normal);
  expect_same(sensor.labels.k_tangential, original.labels.k_tangential);
  expect_same(sensor.labels.mu_static, original.labels.mu_static);
  expect_same(sensor.labels.mu_kinetic, original.labels.mu_kinetic);
  expect_same(sensor.labels.onset_time, original.labels.onset_time);
  expect_same(sensor.labels.micro_onset_time, original.labels.micro_onset_time);
  EXPECT_THAT(sensor.labels.state_count, ElementsAre(0, 0, 40, 0));        // all are 2, incipient
  EXPECT_THAT(sensor.labels.state_micro_count, ElementsAre(0, 0, 0, 40));  // all are 3, gross
  ASSERT_EQ(found.bodies.size(), 1U);
  EXPECT_TRUE(found.bodies[0].size.empty());
  EXPECT_EQ(found.bodies[0].name, "pad");
  expect_same(found.bodies[0].pose, expected.bodies[0].pose);
  expect_same(found.bodies[0].velocity, expected.bodies[0].velocity);
}

TEST_F(DatasetTest, DetectorComesBackAsItWasWritten) {
  const TrialRecord expected = make_controlled_record(0, 41);
  {
    DatasetWriter writer(path("a.h5"), header);
    writer.append(TrialEncoder().encode(expected));
    writer.append(make_trial(1, 41));
    writer.commit();
  }
  const DatasetReader reader(path("a.h5"));
  const TrialRecord found = reader.read_trial(0);
  ASSERT_TRUE(found.control.has_value());
  EXPECT_EQ(found.control->detector, "force_ratio");
  EXPECT_EQ(found.control->sensor, "pad");
  EXPECT_EQ(found.control->rate, 1000.0);
  EXPECT_EQ(found.control->time, expected.control->time);
  EXPECT_EQ(found.control->detector_class, expected.control->detector_class);
  EXPECT_EQ(found.control->confusion, expected.control->confusion);
  EXPECT_EQ(found.outcome.detection, Detection::seen);
  EXPECT_EQ(found.outcome.detection_delay, 0.1);
  EXPECT_EQ(found.outcome.judged_slip_time, 0.3);
  EXPECT_FALSE(reader.read_trial(1).control.has_value());
  EXPECT_EQ(reader.stored_digest(0), trial_digest(found));
}

// Versions before `detection` gave an early alarm a delay and did not store the start of judging.
// The samples show slip without a delay.
TEST_F(DatasetTest, OldOutcomesAreJudgedByTodaysRule) {
  TrialRecord seen = make_controlled_record(0, 41), early = make_controlled_record(1, 41), missed = make_controlled_record(2, 41);
  early.outcome.false_alarm_time = 0.166;
  missed.outcome.detection_time = missed.outcome.detection_delay = std::numeric_limits<double>::quiet_NaN();
  {
    DatasetWriter writer(path("a.h5"), header);
    for (TrialRecord* record : {&seen, &early, &missed}) {
      record->outcome.detection.reset();
      writer.append(TrialEncoder().encode(*record));
    }
    writer.commit();
  }
  const DatasetReader reader(path("a.h5"));
  const TrialOutcome of_seen = reader.read_trial(0).outcome, of_early = reader.read_trial(1).outcome;
  EXPECT_EQ(of_seen.detection, Detection::seen);
  EXPECT_EQ(of_seen.detection_delay, 0.1);
  EXPECT_NEAR(of_seen.judged_slip_time, 0.3, 1e-15);
  EXPECT_EQ(of_early.detection, Detection::early);
  EXPECT_TRUE(std::isnan(of_early.detection_delay));
  EXPECT_EQ(of_early.detection_time, 0.4);
  EXPECT_EQ(reader.read_trial(2).outcome.detection, Detection::missed);
}

TEST_F(DatasetTest, GripperComesBackAsItWasWritten) {
  const TrialRecord expected = make_grasp_record(0, 17);
  write_dataset(path("a.h5"), header, {expected});
  const TrialRecord found = DatasetReader(path("a.h5")).read_trial(0);
  ASSERT_TRUE(found.control.has_value());
  EXPECT_EQ(found.control->controller, "step_on_slip");
  EXPECT_EQ(found.control->grip.command, expected.control->grip.command);
  EXPECT_EQ(found.control->grip.measured_position, expected.control->grip.measured_position);
  EXPECT_EQ(found.control->grip.grip_force, expected.control->grip.grip_force);
  ASSERT_TRUE(found.outcome.grasp.has_value());
  EXPECT_TRUE(found.outcome.grasp->dropped);
  EXPECT_THAT(found.bodies.at(0).size, ElementsAre(0.0625, 0.05, 0.1));
}

// A channel slower than its sensor's samples, and one that never had a row.
TEST_F(DatasetTest, ChannelWithATimeOfItsOwnComesBackAsItWasWritten) {
  TrialRecord record = make_record(0, 7);
  SensorRecord& sensor = record.sensors[0];
  sensor.channels.push_back({"image", "1", {2}, ramp(6, 50.0F), std::vector<double>{2e-3, 4e-3, 6e-3}});
  sensor.channels.push_back({"late", "1", {}, {}, std::vector<double>{}});
  sensor.channel_names.insert(sensor.channel_names.end(), {"I0", "I1", "L"});
  write_dataset(path("a.h5"), header, {record});
  const SensorRecord read = DatasetReader(path("a.h5")).read_trial(0).sensors[0];
  ASSERT_EQ(read.channels.size(), 4U);
  EXPECT_FALSE(read.channels[0].time.has_value());
  for (const std::size_t c : {2U, 3U}) {
    EXPECT_EQ(read.channels[c].time, sensor.channels[c].time);
    EXPECT_EQ(read.channels[c].values, sensor.channels[c].values);
    EXPECT_EQ(read.channels[c].shape, sensor.channels[c].shape);
  }
}

TEST_F(DatasetTest, GuidedArmComesBackAsItWasWritten) {
  TrialRecord expected = make_grasp_record(0, 3);
  expected.control->grip.arm = {0.0F, 0.0F, 0.0F, 0.01F, -0.02F, 0.01F};
  expected.outcome.grasp->turn = {.tilt = 0.25, .least_tilt = 0.125, .standing = false};
  write_dataset(path("a.h5"), header, {expected});
  const TrialRecord found = DatasetReader(path("a.h5")).read_trial(0);
  EXPECT_EQ(found.control->grip.arm, expected.control->grip.arm);
  EXPECT_EQ(found.outcome.grasp->turn->tilt, 0.25);
}

TEST_F(DatasetTest, DetectorThatDoesNotFitItsTrialIsRefused) {
  const auto refusal = [&](const auto& damage) {
    TrialRecord record = make_controlled_record(0, 8);
    damage(*record.control);
    write_dataset(path("a.h5"), header, {record});
    const DatasetReader reader(path("a.h5"));
    return refusal_of([&] { static_cast<void>(reader.read_trial(0)); });
  };
  EXPECT_THAT(refusal([](ControlRecord& control) { control.detector_class[3] = 4; }),
              mentions({"/data/demo_0/control/detector_class", "4"}));
  EXPECT_THAT(refusal([](ControlRecord& control) { control.sensor = "pat"; }), mentions({"/data/demo_0/control", "pat"}));
  EXPECT_THAT(refusal([](ControlRecord& control) { control.time[3] += 1e-3; }), mentions({"/data/demo_0/control", "times"}));
}

TEST_F(DatasetTest, ReadsArraysOfSeveralChunks) {
  const DatasetReader reader(write("a.h5", 1, 100'001, DatasetWriter::default_shard_limit));
  expect_same(reader.read<float>(0, "labels/pad/force"), make_record(0, 100'001).sensors[0].labels.force);
  EXPECT_THAT(reader.shape(0, "labels/pad/force"), ElementsAre(100'001, 2, 3));
}

TEST_F(DatasetTest, DigestIsThatOfTheTrials) {
  const DatasetReader reader(write("a.h5", 3, 40, DatasetWriter::default_shard_limit));
  std::vector<std::pair<std::size_t, Digest>> digests;
  for (const std::size_t trial : reader.trials()) {
    digests.emplace_back(trial, reader.stored_digest(trial));
    EXPECT_EQ(digests.back().second, make_trial(trial, 40).digest);
    EXPECT_EQ(reader.trial_sha256(trial), hexadecimal(digests.back().second));
  }
  EXPECT_THAT(reader.content_sha256(), ElementsAre(reader.stored_sha256(0, digests)));
}

TEST_F(DatasetTest, SameTrialsGiveTheSameBytes) {
  const std::string first = bytes_of(write("a.h5", 5, 40, DatasetWriter::default_shard_limit));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // HDF5's time stamps count seconds
  EXPECT_TRUE(first == bytes_of(write("b.h5", 5, 40, DatasetWriter::default_shard_limit)));
}

TEST_F(DatasetTest, ShardsStayBelowTheLimit) {
  constexpr std::uint64_t limit = 200'000;
  const std::string first = write("a.h5", 20, 500, limit);
  const std::vector<std::string> files = names();
  ASSERT_GE(files.size(), 3U);
  for (const std::string& name : files) EXPECT_LE(std::filesystem::file_size(path(name)), limit) << name;
  EXPECT_THAT(files.back(), "a.h5");
  EXPECT_THAT(files.front(), "a-0001.h5");

  const DatasetReader reader(first);
  EXPECT_EQ(reader.trials().size(), 20U);
  EXPECT_EQ(reader.content_sha256().size(), files.size());
  for (const std::size_t trial : reader.trials()) {
    expect_same(reader.read<float>(trial, "labels/pad/force"), make_record(trial, 500).sensors[0].labels.force);
  }
  // 15 % of 20 trials are 3.
  EXPECT_EQ(reader.mask("test").size(), 3U);
  EXPECT_EQ(reader.mask("valid").size(), 3U);
  EXPECT_EQ(reader.mask("train").size(), 14U);
}

// A part of a sweep also stores the split groups of its trials, as strings of equal length: ten of
// 500 kB need more than one file of 3 MB.
TEST_F(DatasetTest, ShardsOfAPartStayBelowTheLimitWithTheirGroups) {
  constexpr std::uint64_t limit = 3'000'000;
  DatasetHeader of_part = header;
  of_part.part = SweepShard{.number = 1, .count = 2, .trials = 20};
  DatasetWriter writer(path("a.h5"), of_part, limit);
  for (std::size_t k = 0; k < 10; ++k) {
    EncodedTrial trial = make_trial(k, 10);
    trial.material.assign(500'000, 'm');
    writer.append(trial);
  }
  writer.commit();
  ASSERT_GE(names().size(), 2U);
  for (const std::string& name : names()) EXPECT_LE(std::filesystem::file_size(path(name)), limit) << name;
}

TEST_F(DatasetTest, RefusesAShardOfAnotherRun) {
  constexpr std::uint64_t limit = 200'000;
  const std::string first = write("a.h5", 20, 500, limit);
  DatasetHeader other = header;
  other.seed = 8;
  {
    DatasetWriter writer(path("b.h5"), other, limit);
    for (std::size_t k = 0; k < 20; ++k) writer.append(make_trial(k, 500));
    writer.commit();
  }
  std::filesystem::rename(path("b-0001.h5"), path("a-0001.h5"));
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(first); }), mentions({"another dataset"}));
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("a-0002.h5")); }), mentions({"a-0002.h5", "first"}));
  std::filesystem::copy_file(first, path("a-0001.h5"), std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(first); }), mentions({"a-0001.h5", "file 0", "file 1"}));
  std::filesystem::remove(path("a-0001.h5"));
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(first); }), refused_at(path("a-0001.h5"), {"file 1", first}));
}

TEST_F(DatasetTest, TrialsComeInOrder) {
  DatasetWriter writer(path("a.h5"), header);
  writer.append(make_trial(1, 10));
  EXPECT_THROW(writer.append(make_trial(1, 10)), std::logic_error);
}

// Files that people give in place of a dataset, and a word of the error.
TEST_F(DatasetTest, ReaderSaysWhatAFileIs) {
  using namespace std::string_literals;
  const std::string whole = bytes_of(write("whole.h5", 2, 10, DatasetWriter::default_shard_limit));
  const auto cut = [&](std::size_t bytes) {
    return std::pair(whole.substr(0, bytes), fmt::format("is truncated: it has {} ", bytes));
  };
  const std::vector<std::pair<std::string, std::string>> files{
      {"", "is empty"},
      cut(1),
      cut(50),
      cut(whole.size() / 2),
      cut(whole.size() - 1),
      {std::string(1000, '\0'), "is not an HDF5 file"},
      {"t,force\n0,1\n", "is not an HDF5 file"},
      {"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "git lfs pull"},
      {"\n<!DOCTYPE html>\n<html></html>\n", "is an HTML page"},
      {"<HTML><body>404</body></HTML>", "is an HTML page"},
      {"\x1f\x8b\x08\0"s, "gzip"},
      {"\x28\xb5\x2f\xfd"s, "zstd"},
      {"\xfd\x37zXZ\0"s, "xz"},
      {"BZh9", "bzip2"},
      {"PK\x03\x04", "ZIP archive"},
      {"\x89HDF\r\n\x1a\n"s + std::string(1000, '\x7f'), "is damaged: "},
  };
  for (const auto& [bytes, word] : files) {
    std::ofstream(path("other.h5"), std::ios::binary | std::ios::trunc) << bytes;
    EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("other.h5")); }),
                AllOf(HasSubstr(path("other.h5") + ": "), HasSubstr(word)));
  }
  // The file's first bytes hold the size that was written.
  std::ofstream(path("other.h5"), std::ios::binary | std::ios::trunc) << whole.substr(0, whole.size() / 2);
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("other.h5")); }), HasSubstr(fmt::format("of {} bytes", whole.size())));
  std::ofstream(path("other.h5"), std::ios::binary | std::ios::trunc) << whole << '\0';
  EXPECT_EQ(DatasetReader(path("other.h5")).trials().size(), 2U);
  H5Fclose(H5Fcreate(path("other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("other.h5")); }), mentions({"other.h5", "dataset"}));
}

TEST_F(DatasetTest, ReaderNamesWhatIsWrong) {
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("none.h5")); }), mentions({"none.h5", "no such file"}));
  EXPECT_THAT(refusal_of([&] { DatasetReader reader(path("")); }), mentions({"folder"}));
  const DatasetReader reader(write("a.h5", 2, 10, DatasetWriter::default_shard_limit));
  EXPECT_THAT(refusal_of([&] { static_cast<void>(reader.info(2)); }), mentions({"trial 2", "0", "1"}));
  EXPECT_THAT(refusal_of([&] { static_cast<void>(reader.read<float>(0, "labels/pad/speed")); }),
              mentions({"/data/demo_0/labels/pad/speed", "missing"}));
  EXPECT_THAT(refusal_of([&] { static_cast<void>(reader.read<float>(0, "labels/pad")); }), mentions({"labels/pad", "array"}));
}

}  // namespace
}  // namespace slipbench::testing
