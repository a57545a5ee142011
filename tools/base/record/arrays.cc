#include "tools/base/record/arrays.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace slipbench {
namespace {

static_assert(std::endian::native == std::endian::little, "columns are stored as they lie in memory");

constexpr ElementType type_of(double) { return ElementType::f64; }
constexpr ElementType type_of(float) { return ElementType::f32; }
constexpr ElementType type_of(std::uint32_t) { return ElementType::u32; }
constexpr ElementType type_of(std::uint8_t) { return ElementType::u8; }

template <class T>
ArrayView view_of(std::string path, std::string unit, std::size_t rows, const Extents& tail, const std::vector<T>& values) {
  ArrayView view{std::move(path), std::move(unit), {},
                 type_of(T{}),    {rows},          reinterpret_cast<const std::uint8_t*>(values.data())};
  view.shape.insert(view.shape.end(), tail.begin(), tail.end());
  if (view.size_bytes() != values.size() * sizeof(T)) {
    throw std::logic_error(fmt::format("{}: {} values do not fill {} rows", view.path, values.size(), rows));
  }
  return view;
}

}  // namespace

std::vector<ArrayView> arrays_of(const TrialRecord& record) {
  std::vector<ArrayView> arrays;
  for (const SensorRecord& sensor : record.sensors) {
    const std::size_t rows = sensor.time.size();
    const std::string samples = sensor_group(sensor.name) + "/";
    arrays.push_back(view_of(samples + "t", "s", rows, {}, sensor.time));
    for (const SensorColumn& channel : sensor.channels) {
      const std::size_t channel_rows = channel.time ? channel.time->size() : rows;
      arrays.push_back(view_of(samples + channel.name, channel.unit, channel_rows, channel.shape, channel.values));
      if (channel.time) arrays.push_back(view_of(own_time_path(samples + channel.name), "s", channel_rows, {}, *channel.time));
    }
    if (!has_labels(sensor.labels)) continue;
    const std::string labels = label_group(sensor.name) + "/";
    arrays.push_back(view_of(labels + "t", "s", rows, {}, sensor.time));
    for_each_label(sensor.labels, sensor.labels.units(),
                   [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
                     arrays.push_back(view_of(labels + name, unit, rows, tail, column));
                     arrays.back().codes = codes_of(name);
                   });
    const std::size_t events = sensor.labels.event_time.size();
    for_each_event_column(sensor.labels, [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
      arrays.push_back(view_of(labels + name, unit, events, tail, column));
      arrays.back().codes = codes_of(name);
    });
  }
  for (const BodyRecord& body : record.bodies) {
    const std::string truth = body_group(body.name) + "/";
    arrays.push_back(view_of(truth + "t", "s", record.body_time.size(), {}, record.body_time));
    for_each_body_column(body, [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
      arrays.push_back(view_of(truth + name, unit, record.body_time.size(), tail, column));
    });
  }
  if (record.control && !record.sensors.empty()) {
    const std::string control = std::string(control_group) + "/";
    const std::size_t rows = record.control->time.size();
    arrays.push_back(view_of(control + "t", "s", rows, {}, record.control->time));
    const auto add = [&](const char* name, const char* unit, const Extents& tail, const auto& column) {
      arrays.push_back(view_of(control + name, unit, rows, tail, column));
      arrays.back().codes = codes_of(name);
    };
    for_each_control_column(*record.control, add);
    if (record.outcome.grasp) for_each_grip_column(record.control->grip, add);
    if (record.outcome.grasp && record.outcome.grasp->turn) for_each_arm_column(record.control->grip, add);
  }
  std::sort(arrays.begin(), arrays.end(), [](const ArrayView& a, const ArrayView& b) { return a.path < b.path; });
  return arrays;
}

}  // namespace slipbench
