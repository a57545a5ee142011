// An array of piezoresistive cells under a conductive foam: the Myrmex, 16 x 16 taxels of 5 mm.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor.h"

namespace slipbench {

// The catalogue's entry: the parameters of a myrmex.
Entry myrmex_entry();

// The parts of its electronics.
std::vector<Entry> myrmex_electronics();

// A myrmex with one channel "taxels" {rows, columns} [counts], at rest 4095 and less under load. Its pad is the foam's surface, one unit of one
// element a taxel, row by row: taxel (r, c) is at x = (c - (columns - 1)/2) pitch, y = ((rows - 1)/2 - r) pitch, z = 0, so that the image stands
// upright where X is to the right and Y upwards.
// `parameters`: those of myrmex_entry(), all present. `electronics`: applied in this order; empty: ideal, without rounding.
// `seed` of the dataset and `trial` key the random streams, together with `sensor_name`, the scene's name for the sensor.
// Throws SceneValueError for unknown or repeated electronics and for a scan that takes longer than a sample.
std::unique_ptr<Sensor> make_myrmex(const Parameters& parameters, const std::vector<ElectronicsPart>& electronics,
                                    std::uint64_t seed, std::uint64_t trial, const std::string& sensor_name);

}  // namespace slipbench
