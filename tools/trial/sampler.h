// Reads the sensors of a trial at their times.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "sim/api/contact_frame.h"
#include "sim/api/sensor.h"
#include "sim/api/sensor_frame.h"
#include "sim/api/simulation.h"
#include "sim/scene/scene.h"

namespace slipbench {

// Ticks at which a pad's sensor reads the contact, and at which a sample is complete. Ticks are the
// pad's own (simulation.h).
struct Sampling {
  std::size_t stride = 1;  // ticks between two readings
  std::size_t scans = 1;   // readings per sample (Sensor::scans)

  [[nodiscard]] bool reads_at(std::size_t tick) const { return tick % stride == 0; }
  [[nodiscard]] bool completes_at(std::size_t tick) const { return tick % ticks() == (scans - 1) * stride; }
  // Ticks between successive samples.
  [[nodiscard]] std::size_t ticks() const { return stride * scans; }
  // Complete samples in a trial of `trial_ticks` ticks.
  [[nodiscard]] std::size_t samples(std::size_t trial_ticks) const { return ((trial_ticks + stride - 1) / stride) / scans; }
};

// A pad's tick as seen by the loop, without the truth.
struct Tick {
  std::size_t pad = 0;
  double time = 0.0;                    // s
  const SensorFrame* sample = nullptr;  // completed by the tick; null: none. Valid until the sensor is read again
};

// Reads a trial's sensors at their times.
class Sampler {
 public:
  // All arguments must outlive the sampler. Throws SceneValueError if the trial ends before a
  // sensor's first sample is complete; std::logic_error if a sensor needs element_truth that the
  // simulation's frames lack.
  Sampler(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation);

  // True after the last tick of every pad.
  [[nodiscard]] bool finished() const { return remaining_ == 0; }
  // Call once after every step. Returns the ticks at that instant, in the order of pads, after
  // reading every sensor that is due. Valid until the next call.
  std::span<const Tick> measure() {
    std::size_t ticks = 0;
    for (const std::size_t pad : simulation_.stepped()) {
      const FramePart part = pads_[pad].reads() ? FramePart::felt : FramePart::states;
      const ContactFrame& truth = simulation_.contact_part(pad, part);
      ticks_[ticks++] = {pad, truth.time, pads_[pad].measure(truth)};
    }
    remaining_ -= ticks;
    return {ticks_.data(), ticks};
  }

  // Number of samples of the pad's sensor in the trial.
  [[nodiscard]] std::size_t samples(std::size_t pad) const { return pads_[pad].sampling.samples(simulation_.ticks(pad)); }
  // The latest sample of the pad's sensor, valid after the first; includes partial readings of the
  // next sample.
  [[nodiscard]] const SensorFrame& latest(std::size_t pad) const { return *pads_[pad].latest; }

 private:
  struct Pad {
    Sensor* sensor;
    Sampling sampling;
    std::size_t felt_stride;              // ticks between reads or feels of the sensor
    std::size_t tick = 0;                 // index of the next tick
    const SensorFrame* latest = nullptr;  // owned by the sensor

    // reads(): true if the sensor reads or feels the next tick. measure() returns the sample that
    // the tick completes; null: none.
    [[nodiscard]] bool reads() const { return tick % felt_stride == 0; }
    const SensorFrame* measure(const ContactFrame& truth) {
      const bool due = reads();
      const std::size_t now = tick++;
      if (!due) return nullptr;
      if (sampling.completes_at(now)) return latest = &sensor->measure(truth);
      if (felt_stride == sampling.stride || sampling.reads_at(now)) {
        sensor->measure(truth);
      } else {
        sensor->feel(truth);
      }
      return nullptr;
    }
  };

  const Simulation& simulation_;
  std::vector<Pad> pads_;
  std::vector<Tick> ticks_;    // one per pad
  std::size_t remaining_ = 0;  // remaining ticks of all pads
};

}  // namespace slipbench
