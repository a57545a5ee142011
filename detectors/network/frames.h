// Turns a sensor's samples into the network's frames. Training and the loop share this code, so
// both see the same features.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "detectors/network/description.h"
#include "sim/api/sensor_frame.h"

namespace slipbench::network {

// True if samples at `rate` [Hz] have the network's rate within 1 %: the clock of a recorded sensor
// is off by some 0.1 %.
bool rate_fits(const Input& input, double rate);

// Throws InputError if a sensor of this type and these channels does not have the values that the
// network reads, in their physical units.
void check_channels(const Input& input, const std::string& type, std::span<const Channel> channels);

class Frames {
 public:
  // For a sensor of this type, rate [Hz] and channels. Throws InputError if they differ from those
  // in `input`, or if a pick, a pixel, a bin or the number of offsets and scales does not fit.
  Frames(const Input& input, const std::string& type, double rate, std::span<const Channel> channels);
  ~Frames();
  Frames(Frames&&) noexcept;
  Frames& operator=(Frames&&) noexcept;

  // Takes the next sample: all channels in order, each in C order, as in SensorFrame. Returns true
  // if it completes a frame. Does not allocate.
  bool push(std::span<const float> sample);
  // Returns the last complete frame, zeros before the first. [size()]
  [[nodiscard]] std::span<const float> latest() const;
  [[nodiscard]] std::size_t size() const;
  // Discards all samples.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench::network
