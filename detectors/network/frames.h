// A sensor's samples as the frames that a network is fed. Training and the loop share it, so what was learnt is what is seen.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include "detectors/network/description.h"
#include "sim/core/sensor_frame.h"

namespace slipbench::network {

// Whether samples at `rate` [Hz] are of the rate that a network reads, within 1 %: the clock of a recorded sensor is some 0.1 % off.
bool rate_fits(const Input& input, double rate);

class Frames {
 public:
  // For a sensor of this type, rate [Hz] and channels. Throws InputError where they are not those that `input` asks for, and where a pick, a
  // pixel, a bin or the number of offsets and scales does not fit.
  Frames(const Input& input, const std::string& type, double rate, std::span<const Channel> channels);
  ~Frames();
  Frames(Frames&&) noexcept;
  Frames& operator=(Frames&&) noexcept;

  // Takes the next sample: all channels in order, each in C order, as in SensorFrame. True when a frame is complete with it. Allocates nothing.
  bool push(std::span<const float> sample);
  // The last complete frame, zeros before the first. [size()]
  [[nodiscard]] std::span<const float> latest() const;
  [[nodiscard]] std::size_t size() const;
  // As if no sample had come.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slipbench::network
