// Slip told from the power of a signal in a band of frequencies: a threshold with hysteresis, without training.
#pragma once

#include <memory>

#include "sim/core/detector.h"
#include "sim/core/parameters.h"

namespace slipbench {

// The catalogue's entry.
Entry band_energy_entry();

// `parameters`: those of band_energy_entry(), all present. `source` must have the channel "signal" {1}. An estimate a frame of the sensor; it
// changes when a window is complete. Throws SceneValueError where the sensor has no such channel, where window or hop is no whole number of its
// samples, and where no bin of the window's spectrum lies within the band.
std::unique_ptr<Detector> make_band_energy(const Parameters& parameters, const FrameSource& source);

}  // namespace slipbench
