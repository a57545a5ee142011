#include "tools/program/run/delayed_detector.h"

#include <limits>
#include <stdexcept>

namespace slipbench {
namespace {

// Whether `due` has come at `time`. Ticks are multiples of a step and due a sum of a tick and a latency, so that a latency of whole ticks
// may miss its tick by some units in the last place.
bool has_come(double due, double time) { return due <= time + 4.0 * std::numeric_limits<double>::epsilon() * time; }

}  // namespace

void DelayedDetector::update(const SensorFrame& frame) {
  const SlipEstimate& estimate = detector_->update(frame);
  if (!(estimate.latency >= 0.0)) throw std::logic_error("a detector's latency is negative or no number");
  const SlipEstimate& last = under_way_.empty() ? seen_ : under_way_.back();
  if (estimate.time < last.time) throw std::logic_error("a detector's estimate is older than its last one");
  under_way_.push_back(estimate);
}

const SlipEstimate& DelayedDetector::seen_at(double time) {
  for (std::size_t i = under_way_.size(); i-- > 0;) {
    if (!has_come(under_way_[i].time + under_way_[i].latency, time)) continue;
    seen_ = under_way_[i];
    under_way_.erase(under_way_.begin(), under_way_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    break;
  }
  return seen_;
}

}  // namespace slipbench
