#include "detectors/channel.h"

#include "sim/core/error.h"

namespace slipbench {

ChannelPlace vector_channel(const FrameSource& source, std::string_view name, const std::string& detector) {
  constexpr std::size_t axes = 3;
  std::size_t first = 0;
  for (const Channel& channel : source.channels) {
    if (channel.name == name && channel.shape.size() == 2 && channel.shape[1] == axes) return {first, channel.shape[0]};
    first += channel.size();
  }
  throw SceneValueError("detector.sensor", detector + " reads a " + std::string(name) + " in three axes, which the " +
                                               source.type + " " + quote(source.sensor) +
                                               " does not have; allowed: a sensor that has it");
}

std::size_t scalar_channel(const FrameSource& source, std::string_view name, const std::string& detector) {
  std::size_t first = 0;
  for (const Channel& channel : source.channels) {
    if (channel.name == name && channel.size() == 1) return first;
    first += channel.size();
  }
  throw SceneValueError("detector.sensor", detector + " reads a " + std::string(name) + " of one value, which the " +
                                               source.type + " " + quote(source.sensor) +
                                               " does not have; allowed: a sensor that has it");
}

}  // namespace slipbench
