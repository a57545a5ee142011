// The detector inside a trial: what it is fed, and from when on the loop sees what it says.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "sim/core/detector.h"

namespace slipbench {

class DetectorLoop {
 public:
  // `pad`: the one whose sensor the detector reads.
  DetectorLoop(std::unique_ptr<Detector> detector, std::size_t pad) : detector_(std::move(detector)), pad_(pad) {}

  [[nodiscard]] std::size_t pad() const { return pad_; }
  [[nodiscard]] const std::vector<Feature>& features() const { return detector_->features(); }

  // A frame of any pad's sensor; those of others are passed over. Throws std::logic_error when the detector's estimate is older than
  // its last one, or has a latency that is negative or no number.
  void sample(std::size_t pad, const SensorFrame& frame) {
    if (pad == pad_) send(detector_->update(frame));
  }

  // What the loop sees at the tick at `time` [s], after the tick's samples: the latest estimate with estimate.time + estimate.latency
  // <= time, to the rounding of a double. no_contact before the first. Ticks come in ascending order.
  const SlipEstimate& seen_at(double time);

 private:
  void send(const SlipEstimate& estimate);

  std::unique_ptr<Detector> detector_;
  std::size_t pad_;
  std::deque<SlipEstimate> under_way_;  // in order of time
  SlipEstimate seen_;
};

// The loop of a scene without a detector. Nothing of it is left when it is compiled.
struct OpenLoop {
  static void sample(std::size_t, const SensorFrame&) {}
};

}  // namespace slipbench
