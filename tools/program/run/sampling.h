// When sensors are read and when a slow detector's estimates are there.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/core/detector.h"
#include "sim/core/sensor.h"
#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"

namespace slipbench {

// What is sampled when.

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
  const SensorFrame* sample = nullptr;  // that the tick completes; null: none. Stays until the sensor is read again
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
  std::span<const Tick> measure() {
    std::size_t ticks = 0;
    for (const std::size_t pad : simulation_.stepped()) {
      const ContactFrame& truth = simulation_.contact(pad);
      ticks_[ticks++] = {pad, truth.time, pads_[pad].measure(truth)};
    }
    remaining_ -= ticks;
    return {ticks_.data(), ticks};
  }

  // Samples of the pad's sensor in the whole trial.
  [[nodiscard]] std::size_t samples(std::size_t pad) const { return pads_[pad].sampling.samples(simulation_.ticks(pad)); }
  // The latest sample of the pad's sensor, after the first; of a next one that has begun, what has been read of it too.
  [[nodiscard]] const SensorFrame& latest(std::size_t pad) const { return *pads_[pad].latest; }

 private:
  struct Pad {
    Sensor* sensor;
    Sampling sampling;
    std::size_t tick = 0;                 // the next one
    const SensorFrame* latest = nullptr;  // the sensor's own

    // The sample that the next tick completes; null: none.
    const SensorFrame* measure(const ContactFrame& truth) {
      const std::size_t now = tick++;
      if (!sampling.reads_at(now)) return nullptr;
      const SensorFrame& frame = sensor->measure(truth);
      if (!sampling.completes_at(now)) return nullptr;
      return latest = &frame;
    }
  };

  const Simulation& simulation_;
  std::vector<Pad> pads_;
  std::vector<Tick> ticks_;    // room for one of each pad
  std::size_t remaining_ = 0;  // ticks to come, of all pads
};

// A detector inside a trial: an estimate is seen once its latency is over.
class DelayedDetector {
 public:
  explicit DelayedDetector(std::unique_ptr<Detector> detector) : detector_(std::move(detector)) {}

  [[nodiscard]] const std::vector<Feature>& features() const { return detector_->features(); }
  [[nodiscard]] SampleListener* listener() { return detector_->listener(); }
  void finish() { detector_->finish(); }

  // The next frame of its sensor. Throws std::logic_error when the detector's estimate is older than its last one, or has a
  // latency that is negative or no number.
  void update(const SensorFrame& frame);

  // What is seen at the tick at `time` [s], after the tick's update(): the latest estimate with estimate.time + estimate.latency
  // <= time, to the rounding of a double. no_contact before the first. Ticks come in ascending order.
  const SlipEstimate& seen_at(double time);
  // What was seen at the tick last asked for.
  [[nodiscard]] const SlipEstimate& seen() const { return seen_; }

 private:
  std::unique_ptr<Detector> detector_;
  std::deque<SlipEstimate> under_way_;  // in order of time
  SlipEstimate seen_;
};

}  // namespace slipbench
