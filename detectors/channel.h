// Where a detector finds the values it works on.
#pragma once

#include <cstddef>
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

}  // namespace slipbench
