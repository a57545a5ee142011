// Slip told from the rate of each unit's shear force: a unit slips when its shear no longer grows with the load. No training.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The catalogue's entry.
Entry shear_rate_entry();

// `parameters`: those of shear_rate_entry(), all present. `source` must have the channel "force" {N,3} [N], z into the sensor. An estimate a
// frame, without latency; it tells the stuck fraction. Throws SceneValueError where the sensor has no such channel, and at detector.window where
// that is no whole number of frames.
std::unique_ptr<Detector> make_shear_rate(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench
