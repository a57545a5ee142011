// Contactile's PapillArray: nine silicone pillars of three heights, whose tips report a force and a displacement in three axes.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sensors/electronics/electronics.h"
#include "sim/core/parameters.h"
#include "sim/core/sensor.h"

namespace slipbench {

// The catalogue's entry: the parameters of a PapillArray.
Entry papillarray_entry();

// The parts of its electronics, with the figures that were measured on a PapillArray.
std::vector<Entry> papillarray_electronics();

// A PapillArray with channels "force" {9,3} [N] and "displacement" {9,3} [m], pillars P0 to P8, axes x, y, z of the pad frame P
// (+X up, +Y right, +Z into the sensor, connector at the bottom; origin at the undeformed tip of the centre pillar).
// `parameters`: those of papillarray_entry(), all present. `electronics`: applied in this order; empty: ideal.
// `seed` of the dataset and `trial` key the random streams, together with `sensor_name`, the scene's name for the sensor.
// Throws InputError for a rate that the device does not have and for unknown or repeated electronics.
std::unique_ptr<Sensor> make_papillarray(const Parameters& parameters, const std::vector<ElectronicsPart>& electronics,
                                         std::uint64_t seed, std::uint64_t trial, const std::string& sensor_name);

}  // namespace slipbench
