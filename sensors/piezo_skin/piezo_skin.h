// A patch of piezoelectric polymer under a compliant skin, whose charge follows what presses and rubs it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor.h"

namespace slipbench {

// The catalogue's entry: the parameters of a piezo_skin.
Entry piezo_skin_entry();

// The parts of its electronics.
std::vector<Entry> piezo_skin_electronics();

// A piezo_skin with one channel "signal" {1} [counts]. Its pad is the contact under the tip that touches it, one unit of n elements; +X is the
// long side of the patch, +Z into the skin, the origin the mean height of the undeformed contact.
// `parameters`: those of piezo_skin_entry(), all present. `electronics`: applied in this order; empty: ideal.
// `seed` of the dataset and `trial` key the random streams, together with `sensor_name`, the scene's name for the sensor.
// Throws SceneValueError where the position sensor's rate is no whole part of the sensor's, InputError for unknown or repeated electronics.
std::unique_ptr<Sensor> make_piezo_skin(const Parameters& parameters, const std::vector<ElectronicsPart>& electronics,
                                        std::uint64_t seed, std::uint64_t trial, const std::string& sensor_name);

}  // namespace slipbench
