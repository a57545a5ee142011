// Which pillars stick, told from the speeds of their tips, without training.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The catalogue's entry.
Entry stuck_fraction_entry();

// `parameters`: those of stuck_fraction_entry(), all present. `source` must have the channels "force" {N,3} [N] and "displacement" {N,3} [m],
// z into the sensor. An estimate a frame, without latency; it tells the stuck fraction. Throws SceneValueError where the sensor has no such
// channels, and at detector.window where that is no whole number of frames.
std::unique_ptr<Detector> make_stuck_fraction(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench
