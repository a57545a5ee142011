#include "tools/trial/sampler.h"

#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "sim/api/pad_layout.h"
#include "sim/core/error.h"
#include "sim/core/quantity.h"

namespace slipbench {
namespace {

// Throws std::logic_error if a sensor that reads its pad's elements gets frames without them.
void refuse_without_elements(const std::string& sensor, const PadLayout& layout, const ContactFrame& truth) {
  const auto elements = static_cast<Eigen::Index>(layout.elements.size());
  if (!layout.element_truth || (truth.element_depth.size() == elements && truth.element_shear.rows() == elements)) return;
  throw std::logic_error(fmt::format("sensor '{}' reads {} elements of its pad, but the simulation's frames have {}", sensor,
                                     elements, truth.element_depth.size()));
}

}  // namespace

Sampler::Sampler(const Scene& scene, std::span<const std::unique_ptr<Sensor>> sensors, const Simulation& simulation)
    : simulation_(simulation), ticks_(sensors.size()) {
  for (std::size_t pad = 0; pad < sensors.size(); ++pad) {
    const std::string& name = scene.sensors[pad].name;
    refuse_without_elements(name, sensors[pad]->layout(), simulation.contact(pad));
    const Sensor& sensor = *sensors[pad];
    const std::size_t stride = simulation.stride(pad);
    pads_.push_back({.sensor = sensors[pad].get(),
                     .sampling = {stride, sensor.scans()},
                     .felt_stride = sensor.feels_every_tick() ? 1 : stride});
    remaining_ += simulation.ticks(pad);
    if (samples(pad) > 0) continue;
    const double shortest = static_cast<double>(pads_[pad].sampling.ticks()) * simulation.time_step(pad);
    throw SceneValueError("duration", fmt::format("ends before the first sample of sensor '{}' is complete; allowed: {} or more",
                                                  name, format_quantity(shortest, Quantity::time)));
  }
}

}  // namespace slipbench
