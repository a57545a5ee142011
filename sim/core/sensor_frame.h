// What a sensor emits. Detectors and controllers see this and never the truth.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace slipbench {

// One array a sensor emits each sample, as it stands in the dataset: `name` [T, shape...] float32 in `unit`.
struct Channel {
  std::string name;                        // "force"
  std::string unit;                        // "N"
  std::vector<std::size_t> shape;          // {9, 3}
  std::vector<std::string> channel_names;  // one a value, in C order: "P0_FX", ...

  // Of a channel that does not keep pace with its sensor's samples; in the dataset it then has a time of its own, `name`_t.
  std::size_t every = 1;  // its values are new in the last of every so many samples and stand still in between
  double age = 0.0;       // s, how long before the frame's time they were read, in the mean

  [[nodiscard]] bool has_own_time() const { return every != 1 || age != 0.0; }

  [[nodiscard]] std::size_t size() const {
    std::size_t product = 1;
    for (const std::size_t extent : shape) product *= extent;
    return product;
  }
};

// What a sensor reports at one instant. Valid until the next measure().
struct SensorFrame {
  double time = 0.0;              // s
  std::span<const float> values;  // all channels in order, each in C order
};

// One sensor of a scene, as a detector or a controller may know it.
struct SensorSource {
  std::string name;               // the scene's own: "pad"
  std::string type;               // "papillarray"
  double rate = 0.0;              // Hz, of its samples
  std::vector<Channel> channels;  // what a sample holds
};

// Who is handed the samples of every sensor of a scene.
class SampleListener {
 public:
  virtual ~SampleListener() = default;

  // The next sample of sensor number `sensor` in the scene's order, in order of time. `sample` is valid during the call only.
  virtual void hear(std::size_t sensor, const SensorFrame& sample) = 0;
};

}  // namespace slipbench
