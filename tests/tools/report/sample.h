// A small trial with known answers.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "tests/tools/dataset/record/test_records.h"
#include "tests/tools/page/unpack.h"

namespace slipbench::report {

using page::unpack;

inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

// Two units (A at x = +7 mm, B at -7 mm), eight samples at 1 kHz:
//   sample          0  1  2  3  4  5  6  7
//   unit A          -  S  S  P  L  L  L  L      touches at 0.5 ms, micro-slip at 2.25 ms, slips at 3.5 ms
//   unit B          -  -  S  S  S  P  L  L      touches at 1.5 ms, micro-slip at 4.5 ms, slips at 5.75 ms
//   state strict    0  1  1  1  2  2  3  3
//   state micro     0  1  1  2  2  3  3  3
//   state paper     0  1  1  1  1  2  3  3
// with - detached, S stick, P partial, L slip. The body moves sideways from sample 2 on.
inline TrialRecord sample_trial(std::size_t trial, const std::string& params) {
  TrialRecord record;
  record.trial = trial;
  record.seed = 7;
  record.material = "acrylic";
  record.params = params;
  SensorRecord sensor;
  sensor.name = "pad";
  sensor.type = "papillarray";
  sensor.rate = 1000.0;
  sensor.frame = "+X up, +Y right, +Z into the sensor";
  sensor.channel_names = {"P0_FX", "P0_FY", "P0_FZ", "P1_FX", "P1_FY", "P1_FZ",
                          "P0_DX", "P0_DY", "P0_DZ", "P1_DX", "P1_DY", "P1_DZ"};
  SensorColumn force{"force", "N", {2, 3}, {}};
  SensorColumn displacement{"displacement", "m", {2, 3}, {}};
  LabelRecord& labels = sensor.labels;
  for (int i = 0; i < 8; ++i) {
    sensor.time.push_back(1e-3 * i);
    record.body_time.push_back(1e-3 * i);
    for (int k = 0; k < 6; ++k) {
      force.values.push_back(0.125F * static_cast<float>(i) - 0.25F * static_cast<float>(k));
      displacement.values.push_back(1e-5F * static_cast<float>(i + k));
      labels.force.push_back(0.125F * static_cast<float>(i) - 0.25F * static_cast<float>(k));
    }
    for (int k = 0; k < 4; ++k) labels.slip_velocity.push_back(i < 4 ? 0.0F : 0.004F);
    for (int k = 0; k < 2; ++k) labels.slip_distance.push_back(i < 4 ? 0.0F : 4e-6F * static_cast<float>(i - 3));
    labels.margin.insert(labels.margin.end(),
                         {i == 0 ? not_a_number : 1.0F - 0.125F * static_cast<float>(i), i < 2 ? not_a_number : 0.5F});
    labels.stuck_fraction.push_back(i == 0 ? not_a_number : 1.0F);
    labels.slip_direction.push_back(i < 4 ? not_a_number : 0.5F);
    labels.slip_angle.push_back(0.0F);
    labels.slip_centre.insert(labels.slip_centre.end(), {not_a_number, not_a_number});
  }
  sensor.channels = {force, displacement};
  labels.unit_state = {0, 0, 1, 0, 1, 1, 3, 1, 2, 1, 2, 3, 2, 2, 2, 2};
  labels.state = {0, 1, 1, 1, 2, 2, 3, 3};
  labels.state_micro = {0, 1, 1, 2, 2, 3, 3, 3};
  labels.state_paper = {0, 1, 1, 1, 1, 2, 3, 3};
  labels.event_time = {0.5e-3, 1.5e-3, 2.25e-3, 3.5e-3, 4.5e-3, 5.75e-3};
  labels.event_unit = {0, 1, 0, 0, 1, 1};
  labels.event_kind = {0, 0, 4, 1, 4, 1};
  labels.unit_positions = {7e-3, 0.0, -7e-3, 0.0};
  labels.unit_heights = {0.0, 0.0};
  labels.k_normal = {1200.0, 1200.0};
  labels.k_tangential = {650.0, 650.0};
  labels.mu_static = {0.5, 0.5};
  labels.mu_kinetic = {0.5, 0.5};
  labels.onset_time = {3.5e-3, 5.75e-3};
  labels.micro_onset_time = {2.25e-3, 4.5e-3};
  record.sensors.push_back(sensor);
  BodyRecord body{"pad", {}, {}};
  for (int i = 0; i < 8; ++i) {
    body.pose.insert(body.pose.end(), {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F});
    body.velocity.insert(body.velocity.end(), {i < 2 ? 0.0F : 0.004F, 0.0F, i < 2 ? -0.001F : 0.0F, 0.0F, 0.0F, 0.0F});
  }
  record.bodies.push_back(body);
  return record;
}

// The same as a grasp by "step_on_slip" with the oracle: from row 3 on the arm rises by 2 mm per
// row, the box by 1 mm from -20 mm, and the box turns about the vertical by 0.01 rad per row. The
// grip force is 0.5 N per row; 71 counts and more are commanded, 70 and more measured. Bodies: pad,
// arm, box.
inline TrialRecord sample_grasp(std::size_t trial) {
  TrialRecord record = sample_trial(trial, "{}");
  BodyRecord arm{"arm", {}, {}}, box{"box", {}, {}, {0.0625, 0.05, 0.1}};
  ControlRecord control;
  control.detector = "truth";
  control.controller = "step_on_slip";
  control.sensor = "pad";
  control.rate = 1000.0;
  control.time = record.sensors[0].time;
  for (int i = 0; i < 8; ++i) {
    const auto since = static_cast<float>(i < 3 ? 0 : i - 3);
    arm.pose.insert(arm.pose.end(), {0.0F, 0.0F, 2e-3F * since, 1.0F, 0.0F, 0.0F, 0.0F});
    arm.velocity.insert(arm.velocity.end(), {0.0F, 0.0F, i < 4 ? 0.0F : 2.0F, 0.0F, 0.0F, 0.0F});
    box.pose.insert(box.pose.end(),
                    {0.0F, 0.0F, -0.02F + 1e-3F * since, std::cos(5e-3F * since), 0.0F, 0.0F, std::sin(5e-3F * since)});
    box.velocity.insert(box.velocity.end(), 6, 0.0F);
    control.detector_class.push_back(1);
    const auto row = static_cast<std::uint8_t>(i);
    control.grip.command.insert(control.grip.command.end(), {static_cast<std::uint8_t>(71 + row), 0, 0});
    control.grip.measured_position.push_back(static_cast<std::uint8_t>(70 + row));
    control.grip.grip_force.push_back(0.5F * static_cast<float>(i));
  }
  record.bodies = {record.bodies.front(), std::move(arm), std::move(box)};
  record.control = std::move(control);
  record.outcome.grasp =
      GraspOutcome{.slip_translation = 4e-3, .max_grip_force = 3.5, .final_grip_force = 3.5, .ideal_grip_force = 2.0};
  return record;
}

// Writes a dataset of trials and returns its path.
inline std::string write_dataset(const std::string& name, const std::string& scene, const std::vector<TrialRecord>& trials) {
  const std::string path = (std::filesystem::path(::testing::TempDir()) / name).string();
  return slipbench::testing::write_dataset(path, {"0.1.0", scene, "{}", 7, "slipbench run scene.yaml"}, trials);
}

inline void write_text(const std::string& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

}  // namespace slipbench::report
