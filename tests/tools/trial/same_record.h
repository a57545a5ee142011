// Compares records byte by byte.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/dataset/record/encoder.h"
#include "tools/dataset/record/trial_record.h"

namespace slipbench::testing_run {

// NaN equals itself here, and 0 differs from -0.
template <class Value>
bool same_bytes(const std::vector<Value>& a, const std::vector<Value>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Value)) == 0);
}

// Every array and attribute of sensors/<name> and labels/<name>.
inline void expect_same_sensor(const SensorRecord& one, const SensorRecord& other) {
  EXPECT_EQ(one.name, other.name);
  EXPECT_EQ(one.type, other.type);
  EXPECT_EQ(one.rate, other.rate);
  EXPECT_EQ(one.frame, other.frame);
  EXPECT_EQ(one.follows, other.follows);
  EXPECT_EQ(one.channel_names, other.channel_names);
  EXPECT_TRUE(same_bytes(one.time, other.time)) << one.name << "/t";
  ASSERT_EQ(one.channels.size(), other.channels.size());
  for (std::size_t c = 0; c < one.channels.size(); ++c) {
    const std::string path = one.name + "/" + one.channels[c].name;
    EXPECT_TRUE(same_bytes(one.channels[c].values, other.channels[c].values)) << path;
    ASSERT_EQ(one.channels[c].time.has_value(), other.channels[c].time.has_value()) << path;
    if (!one.channels[c].time) continue;
    EXPECT_TRUE(same_bytes(*one.channels[c].time, *other.channels[c].time)) << path << "_t";
  }
  struct Column {
    const void* data;
    std::size_t bytes;
    std::string name;
  };
  const auto columns = [](const LabelRecord& labels) {
    std::vector<Column> all;
    const auto add = [&all](const std::string& name, const auto& column) {
      all.push_back({column.data(), column.size() * sizeof(column.front()), name});
    };
    for_each_label(labels, labels.units(),
                   [&](const char* name, const char*, const Extents&, const auto& column) { add(name, column); });
    for_each_event_column(labels, [&](const char* name, const char*, const Extents&, const auto& column) { add(name, column); });
    for_each_unit_attribute(labels,
                            [&](const char* name, const char*, const Extents&, const auto& column) { add(name, column); });
    return all;
  };
  const std::vector<Column> a = columns(one.labels), b = columns(other.labels);
  for (std::size_t c = 0; c < a.size(); ++c) {
    const bool same = a[c].bytes == b[c].bytes && (a[c].bytes == 0 || std::memcmp(a[c].data, b[c].data, a[c].bytes) == 0);
    EXPECT_TRUE(same) << "labels/" << one.name << "/" << a[c].name;
  }
  EXPECT_EQ(one.labels.state_count, other.labels.state_count);
  EXPECT_EQ(one.labels.state_micro_count, other.labels.state_micro_count);
}

inline void expect_same_control(const ControlRecord& one, const ControlRecord& other) {
  EXPECT_EQ(one.detector, other.detector);
  EXPECT_EQ(one.controller, other.controller);
  EXPECT_EQ(one.sensor, other.sensor);
  EXPECT_EQ(one.rate, other.rate);
  EXPECT_TRUE(same_bytes(one.time, other.time)) << "control/t";
  EXPECT_TRUE(same_bytes(one.detector_class, other.detector_class)) << "control/detector_class";
  EXPECT_TRUE(same_bytes(one.grip.command, other.grip.command));
  EXPECT_TRUE(same_bytes(one.grip.measured_position, other.grip.measured_position));
  EXPECT_TRUE(same_bytes(one.grip.grip_force, other.grip.grip_force));
  EXPECT_TRUE(same_bytes(one.grip.arm, other.grip.arm));
  EXPECT_EQ(one.confusion, other.confusion);
}

}  // namespace slipbench::testing_run
