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
  // Number of readings per sample: more than one if a multiplexed sensor reads its values at
  // different instants.
  [[nodiscard]] virtual std::size_t scans() const { return 1; }
  // Returns the channels of a sample.
  [[nodiscard]] virtual const std::vector<Channel>& channels() const = 0;
  // Reads the contact, of which only the parts of FramePart::felt are valid; the others may be from
  // an earlier tick. Called rate() scans() times per second, in order of time, from the beginning
  // of the trial. The last of the scans() calls of a sample completes it: the frame is then the
  // sample. Before that call the frame holds the values read so far.
  virtual const SensorFrame& measure(const ContactFrame& truth) = 0;
  // True if feel() must be called at every tick of the simulation between two calls of measure():
  // the sensor has a filter before its converter.
  [[nodiscard]] virtual bool feels_every_tick() const { return false; }
  // Processes the contact at a tick without reading it. Uses the same parts of the contact as
  // measure(). Called in order of time.
  virtual void feel(const ContactFrame& /*truth*/) {}
  // The state that the sensor carries from one sample to the next. A caller that saves and restores
  // the state of a bench saves and overwrites these spans, whose addresses are constant as long as
  // the sensor exists. Empty: the sensor has no state.
  [[nodiscard]] virtual std::vector<std::span<double>> memory() { return {}; }
  // Number of samples so far with a value beyond the range of the sensor: clipped by its converter,
  // or counted by the part valid_range of its electronics. The number counts readings, so it is not
  // part of memory(). A sensor whose readings pass through Electronics adds the count of
  // Electronics.
  [[nodiscard]] virtual std::uint64_t saturated() const { return 0; }
  // Called once after the last measure(). Throws InputError if the backend of the sensor fails as
  // it ends.
  virtual void finish() {}
  // Returns the label that the sensor's paper would have given the contact, in addition to the
  // truth. `rotating`: the bench rotates the pad.
  [[nodiscard]] virtual PadState paper_label(const ContactFrame& truth, bool rotating) const = 0;
};

}  // namespace slipbench
