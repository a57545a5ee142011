// Where a detector finds the values it works on.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "sim/core/detector.h"

namespace slipbench {

// Values of one channel inside a frame.
struct ChannelPlace {
  std::size_t first = 0;  // index into SensorFrame::values
  std::size_t units = 0;  // extent of the channel's first axis
};

// The channel `name` of `source`, which must hold three axes for each of its units: extents {N, 3}. `detector` names who asks.
// Throws SceneValueError at detector.sensor where the sensor has no such channel.
ChannelPlace vector_channel(const FrameSource& source, std::string_view name, const std::string& detector);

// Index into SensorFrame::values of the channel `name`, which must hold one value: extents {1}. `detector` names who asks. Throws
// SceneValueError at detector.sensor where the sensor has no such channel.
std::size_t scalar_channel(const FrameSource& source, std::string_view name, const std::string& detector);

// The three values (x, y, z of the pad frame) of `unit` in `frame`.
inline std::span<const float, 3> vector_at(const SensorFrame& frame, const ChannelPlace& place, std::size_t unit) {
  return frame.values.subspan(place.first + 3 * unit).first<3>();
}

// A unit's force [N].
struct UnitForce {
  double normal;
  double tangential;  // length of x and y
};

inline UnitForce force_at(const SensorFrame& frame, const ChannelPlace& force, std::size_t unit) {
  const auto f = vector_at(frame, force, unit);
  return {f[2], std::hypot(double{f[0]}, double{f[1]})};
}

}  // namespace slipbench
