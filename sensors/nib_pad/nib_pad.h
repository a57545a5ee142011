// The capacitive nib pad: 6x6 silicone nibs over electrodes that a multiplexer clusters anew at each reading.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor.h"

namespace slipbench {

// The catalogue's entry: the parameters of a nib pad.
Entry nib_pad_entry();

// The parts that its electronics have, with the figures of signal_model.cc. Rounding to counts is not one of them: it is what the device
// does, parameter `bits`.
std::vector<Entry> nib_pad_electronics();

// A nib pad with channels "si" {9,4}, "fl" {2} and "fr" {2}, raw counts of its converter. Pad frame P: +X east, +Y north, +Z into the
// sensor, origin at the tip of a nib of nominal height in the pad's middle. Units are nibs, 6 row + column, rows from north to south,
// columns from west to east; taxels of si likewise, 3 row + column, their electrodes W, N, E, S. fl: the clusters N and S; fr: + and -.
// With `scan: multiplexed` a sample is eight readings (Sensor::scans): fl N, fl S, fr +, fr -, then W, N, E, S of one taxel, the next taxel
// in the next sample; si is complete in the last of every nine samples. What a sample reads is in its frame once its last reading is done.
// `parameters`: those of nib_pad_entry(), all present. `electronics`: applied in this order; empty: ideal, which still rounds to counts.
// `seed` of the dataset and `trial` key the random streams, together with `sensor_name`, the scene's name for the sensor.
// Throws SceneValueError for a gap of the mask that is none, InputError for unknown or repeated electronics.
std::unique_ptr<Sensor> make_nib_pad(const Parameters& parameters, const std::vector<ElectronicsPart>& electronics,
                                     std::uint64_t seed, std::uint64_t trial, const std::string& sensor_name);

}  // namespace slipbench
