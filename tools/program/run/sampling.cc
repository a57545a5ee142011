#include "tools/program/run/sampling.h"

#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// A sensor that reads between its units must ride on a pad that tells of each element.
void refuse_without_elements(const std::string& sensor, const PadLayout& layout, const ContactFrame& truth) {
  const auto elements = static_cast<Eigen::Index>(layout.elements.size());
  if (!layout.element_truth || (truth.element_depth.size() == elements && truth.element_shear.rows() == elements)) return;
  throw std::logic_error(fmt::format("sensor '{}' reads {} elements of its pad, and the simulation's frames tell of {}", sensor,
                                     elements, truth.element_depth.size()));
}

// Whether `due` has come at `time`. Ticks are multiples of a step and due a sum of a tick and a latency, so that a latency of whole ticks
// may miss its tick by some units in the last place.
bool has_come(double due, double time) { return due <= time + 4.0 * std::numeric_limits<double>::epsilon() * time; }

}  // namespace

Sampler::Sampler(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation)
    : simulation_(simulation), ticks_(sensors.size()) {
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    const std::string& name = scene.sensors[pad].name;
    refuse_without_elements(name, sensors[pad]->layout(), simulation.contact(pad));
    pads_.push_back({.sensor = sensors[pad].get(), .sampling = {simulation.stride(pad), sensors[pad]->scans()}});
    remaining_ += simulation.ticks(pad);
    if (samples(pad) > 0) continue;
    const double shortest = static_cast<double>(pads_[pad].sampling.ticks()) * simulation.time_step(pad);
    throw SceneValueError("duration",
                          fmt::format("ends before the first sample of sensor '{}' is complete; allowed: {} or longer", name,
                                      format_quantity(shortest, Quantity::time)));
  }
}

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
