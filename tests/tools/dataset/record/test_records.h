// Small trials in which the index determines every value, and a folder to write them to.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/expect.h"
#include "tests/files.h"
#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/trial_record.h"
#include "tools/dataset/writer.h"

namespace slipbench::testing {

inline std::vector<float> ramp(std::size_t size, float start) {
  std::vector<float> values(size);
  for (std::size_t i = 0; i < size; ++i) values[i] = start + 0.001F * static_cast<float>(i);
  return values;
}

// A trial of `rows` samples of a sensor with two units, two channels and three events.
inline TrialRecord make_record(std::size_t trial, std::size_t rows, const std::string& material = "acrylic") {
  constexpr std::size_t units = 2;
  const auto start = static_cast<float>(trial);
  TrialRecord record;
  record.trial = trial;
  record.seed = 7;
  record.material = material;
  record.params = R"({"motion.speed": 0.004})";
  record.outcome.touch_time = 0.125;
  record.outcome.max_slip_distance = 0.5 * static_cast<double>(trial);

  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "papillarray";
  sensor.rate = 1000.0;
  sensor.frame = "x, y, z";
  sensor.channel_names = {"P0_FX", "P1_FX", "P0_D\xC3\xA9"};
  for (std::size_t i = 0; i < rows; ++i) sensor.time.push_back(1e-3 * static_cast<double>(i));
  // Not in alphabetical order: the order of channels must survive the file, which sorts.
  sensor.channels.push_back({"force", "N", {units}, ramp(rows * units, start)});
  sensor.channels.push_back({"displacement", "m", {}, ramp(rows, start + 100.0F)});
  LabelRecord& labels = sensor.labels;
  labels.unit_state.assign(rows * units, 1);
  labels.slip_velocity = ramp(rows * units * 2, start + 1.0F);
  labels.slip_distance = ramp(rows * units, start + 2.0F);
  labels.margin = ramp(rows * units, start + 3.0F);
  labels.force = ramp(rows * units * 3, start + 4.0F);
  labels.state.assign(rows, 2);
  labels.state_micro.assign(rows, 3);
  labels.state_paper.assign(rows, 1);
  labels.stuck_fraction = ramp(rows, start + 5.0F);
  labels.slip_direction.assign(rows, std::numeric_limits<float>::quiet_NaN());
  labels.slip_centre = ramp(rows * 2, start + 6.0F);
  labels.slip_angle = ramp(rows, start + 7.0F);
  labels.event_time = {0.1, 0.2, 0.3};
  labels.event_unit = {0, 1, 1};
  labels.event_kind = {0, 0, 1};
  labels.unit_positions = {0.007, 0.0, -0.007, 0.0};
  labels.unit_heights = {0.0, 0.0002};
  labels.k_normal = {7100.0, 7200.0};
  labels.k_tangential = {3900.0, 4000.0};
  labels.mu_static = {0.5, 0.5};
  labels.mu_kinetic = {0.4, 0.4};
  labels.onset_time = {std::numeric_limits<double>::quiet_NaN(), 0.3};
  labels.micro_onset_time = {std::numeric_limits<double>::quiet_NaN(), 0.3};
  record.sensors.push_back(std::move(sensor));

  record.body_time = record.sensors[0].time;
  record.bodies.push_back({"pad", ramp(rows * 7, start + 8.0F), ramp(rows * 6, start + 9.0F)});
  return record;
}

// The same with a detector whose class cycles through all states while the truth is incipient.
inline TrialRecord make_controlled_record(std::size_t trial, std::size_t rows) {
  TrialRecord record = make_record(trial, rows);
  ControlRecord control;
  control.detector = "force_ratio";
  control.sensor = "pad";
  control.rate = 1000.0;
  control.time = record.sensors[0].time;
  for (std::size_t row = 0; row < rows; ++row) {
    control.detector_class.push_back(static_cast<std::uint8_t>(row % 4));
    ++control.confusion[2][row % 4];
  }
  record.control = std::move(control);
  record.outcome.detection_time = 0.4;
  record.outcome.detection_delay = 0.1;
  record.outcome.judged_slip_time = 0.3;
  record.outcome.detection = Detection::seen;
  return record;
}

// The same for a grasp: registers, positions and forces identify their row.
inline TrialRecord make_grasp_record(std::size_t trial, std::size_t rows) {
  TrialRecord record = make_controlled_record(trial, rows);
  record.control->controller = "step_on_slip";
  record.bodies[0].size = {0.0625, 0.05, 0.1};
  for (std::size_t row = 0; row < rows; ++row) {
    for (const std::size_t value : {row, row + 1, row + 2})
      record.control->grip.command.push_back(static_cast<std::uint8_t>(value));
    record.control->grip.measured_position.push_back(static_cast<std::uint8_t>(row + 3));
    record.control->grip.grip_force.push_back(static_cast<float>(row) + 0.5F);
  }
  record.outcome.grasp = GraspOutcome{.dropped = true, .drop_time = 1.5, .max_grip_force = 7.0, .ideal_grip_force = 3.0};
  return record;
}

inline EncodedTrial make_trial(std::size_t trial, std::size_t rows, const std::string& material = "acrylic") {
  return TrialEncoder().encode(make_record(trial, rows, material));
}

// Writes all of `records` and returns the path.
inline std::string write_dataset(const std::string& path, const DatasetHeader& header, const std::vector<TrialRecord>& records) {
  DatasetWriter writer(path, header);
  for (const TrialRecord& record : records) writer.append(TrialEncoder().encode(record));
  writer.commit();
  return path;
}

// Runs `action` in a child process and returns its wait status: exit 3 if it throws.
inline int in_child(const std::function<void()>& action) {
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    try {
      action();
    } catch (...) {
      ::_exit(3);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

// A fresh folder for each test, removed at its end.
struct FolderTest : ::testing::Test {
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  // Names in the folder, sorted.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace slipbench::testing
