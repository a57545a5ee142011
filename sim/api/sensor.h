// A sensor: a readout of one pad's contact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/pad_layout.h"
#include "sim/api/sensor_frame.h"

namespace slipbench {

class Sensor {
 public:
  virtual ~Sensor() = default;

  // The pad that the field simulates for this sensor.
  [[nodiscard]] virtual const PadLayout& layout() const = 0;
  // Samples a second [Hz].
  [[nodiscard]] virtual double rate() const = 0;
  // How many readings make a sample: more than one where a multiplexed sensor reads its values at different instants.
  [[nodiscard]] virtual std::size_t scans() const { return 1; }
  // Returns the channels of a sample.
  [[nodiscard]] virtual const std::vector<Channel>& channels() const = 0;
  // Reads of the contact what FramePart::felt names; the rest may be of an earlier tick. Called rate() scans() times a second, in order of time,
  // from the trial's beginning on. Of the scans() calls of a sample the last completes it: its frame is the sample. Before, the frame holds what
  // has been read so far.
  virtual const SensorFrame& measure(const ContactFrame& truth) = 0;
  // True if feel() must be called at every tick of the simulation between two calls of measure(): the sensor has a filter before its converter.
  [[nodiscard]] virtual bool feels_every_tick() const { return false; }
  // Takes in the contact at a tick without reading it. Reads the same part of the contact as measure(). Called in order of time.
  virtual void feel(const ContactFrame& /*truth*/) {}
  // All that the sensor carries from one sample to the next, to be saved and overwritten by whoever keeps a bench's state. The spans stay
  // where they are as long as the sensor lives. Empty: it has no memory.
  [[nodiscard]] virtual std::vector<std::span<double>> memory() { return {}; }
  // Samples so far with a value beyond the sensor's range: cut off by its converter, or counted by the part valid_range of its electronics. A
  // tally of what has been read, so it is no part of memory(). A sensor whose readings pass through Electronics adds its count.
  [[nodiscard]] virtual std::uint64_t saturated() const { return 0; }
  // Once after the last measure(). Throws InputError where what stands behind the sensor fails as it ends.
  virtual void finish() {}
  // The label that the sensor's paper would have given the contact, beside the truth; `rotating` says whether the bench turns.
  [[nodiscard]] virtual PadState paper_label(const ContactFrame& truth, bool rotating) const = 0;
};

}  // namespace slipbench
