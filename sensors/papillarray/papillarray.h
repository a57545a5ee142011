// Contactile's PapillArray: nine silicone pillars of three heights, whose tips report a force and a displacement in three axes.
#pragma once

#include "sim/core/sensor_kind.h"

namespace slipbench {

// A PapillArray with channels "force" {9,3} [N] and "displacement" {9,3} [m], pillars P0 to P8, axes x, y, z of the pad frame P
// (+X up, +Y right, +Z into the sensor, connector at the bottom; origin at the undeformed tip of the centre pillar).
// create() throws InputError for a rate that the device does not have and for unknown or repeated electronics.
SensorKind papillarray_sensor();

}  // namespace slipbench
