// The output of a sensor. Detectors and controllers see this and never the truth.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace slipbench {

// One array that a sensor emits per sample, as stored in the dataset: `name` [T, shape...] float32
// in `unit`.
struct Channel {
  std::string name;                        // "force"
  std::string unit;                        // "N"
  std::vector<std::size_t> shape;          // {9, 3}
  std::vector<std::string> channel_names;  // one per value, in C order: "P0_FX", ...

  // For a channel slower than the samples of its sensor. In the dataset such a channel has its own
  // time, `name`_t. Its values change in the last of every `every` samples and are constant in
  // between.
  std::size_t every = 1;
  double age = 0.0;  // s, mean time from reading the values to the frame's time

  // Unit in which simulated sensors of this type have the channel (SensorView::channels); empty: unknown.
  std::string usual_unit = {};

  [[nodiscard]] bool has_own_time() const { return every != 1 || age != 0.0; }

  [[nodiscard]] std::size_t size() const {
    std::size_t product = 1;
    for (const std::size_t extent : shape) product *= extent;
    return product;
  }
};

// A sensor's output at one instant. Valid until the next measure().
struct SensorFrame {
  double time = 0.0;              // s
  std::span<const float> values;  // all channels in order, each in C order
};

// One sensor of a scene, with the facts that a detector or a controller may know.
struct SensorSource {
  std::string name;               // the scene's name for it: "pad"
  std::string type;               // "papillarray"
  double rate = 0.0;              // Hz, of its samples
  std::vector<Channel> channels;  // what a sample holds
};

// Receives the samples of every sensor of a scene.
class SampleListener {
 public:
  virtual ~SampleListener() = default;

  // Takes the next sample of sensor number `sensor` in the scene's order, in order of time.
  // `sample` is valid during the call only.
  virtual void hear(std::size_t sensor, const SensorFrame& sample) = 0;
};

}  // namespace slipbench
