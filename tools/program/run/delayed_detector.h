// A detector inside a trial: an estimate is seen once its latency is over.
#pragma once

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "sim/core/detector.h"

namespace slipbench {

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
