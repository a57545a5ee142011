// What is sampled when.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "sim/core/sensor.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

// When a pad's sensor reads the contact, and when that completes a sample. Ticks are the pad's own (simulation.h).
struct Sampling {
  std::size_t stride = 1;  // ticks between two readings
  std::size_t scans = 1;   // readings a sample (Sensor::scans)

  [[nodiscard]] bool reads_at(std::size_t tick) const { return tick % stride == 0; }
  [[nodiscard]] bool completes_at(std::size_t tick) const { return tick % ticks() == (scans - 1) * stride; }
  // Ticks between two samples.
  [[nodiscard]] std::size_t ticks() const { return stride * scans; }
  // Samples that are complete in a trial of so many ticks.
  [[nodiscard]] std::size_t samples(std::size_t trial_ticks) const { return ((trial_ticks + stride - 1) / stride) / scans; }
};

// A pad's tick as the loop may see it: without the truth.
struct Tick {
  std::size_t pad = 0;
  double time = 0.0;                    // s
  const SensorFrame* sample = nullptr;  // that the tick completes; null: none. Stays until the sensor's next one
};

// Reads a trial's sensors when their time has come.
class Sampler {
 public:
  // All must outlive the sampler. Throws SceneValueError when the trial ends before a sensor's first sample is complete; std::logic_error
  // when a sensor asks for element_truth and the simulation's frames do not carry it.
  Sampler(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation);

  // Whether every pad has had its ticks.
  [[nodiscard]] bool finished() const { return remaining_ == 0; }
  // Once after every step: the ticks at that instant, in the order of pads, for which every sensor that is due has been read. Stays until
  // the next call.
  std::span<const Tick> measure();

  // Samples of the pad's sensor in the whole trial.
  [[nodiscard]] std::size_t samples(std::size_t pad) const { return sampling_[pad].samples(simulation_.ticks(pad)); }
  // The latest sample of the pad's sensor.
  [[nodiscard]] const SensorFrame& latest(std::size_t pad) const { return latest_[pad]; }

 private:
  std::span<const std::unique_ptr<Sensor>> sensors_;
  const Simulation& simulation_;
  std::vector<Sampling> sampling_;   // by pad
  std::vector<std::size_t> count_;   // by pad, of its ticks so far
  std::vector<SensorFrame> latest_;  // by pad; the values are the sensor's own
  std::vector<Tick> ticks_;          // at this instant
  std::size_t remaining_ = 0;        // ticks to come, of all pads
};

}  // namespace slipbench
