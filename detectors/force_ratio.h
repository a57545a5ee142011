// Slip told from the ratio of tangential to normal force: Coulomb's law read backwards, without training.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The catalogue's entry.
Entry force_ratio_entry();

// `parameters`: those of force_ratio_entry(), all present. `source` must have the channel "force" {N,3} [N], z into the sensor.
// An estimate a frame, without latency and without memory. Throws SceneValueError where the sensor has no such channel.
std::unique_ptr<Detector> make_force_ratio(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench
