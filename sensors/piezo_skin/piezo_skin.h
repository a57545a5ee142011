// A patch of piezoelectric polymer under a compliant skin, whose charge follows what presses and rubs it.
#pragma once

#include "sim/core/sensor_kind.h"

namespace slipbench {

// A piezo_skin with one channel "signal" {1} [counts]. Its pad is the contact under the tip that touches it, one unit of n
// elements; +X is the long side of the patch, +Z into the skin, the origin the mean height of the undeformed contact. create()
// throws SceneValueError where the position sensor's rate is no whole part of the sensor's, InputError for unknown or repeated
// electronics.
SensorKind piezo_skin_sensor();

}  // namespace slipbench
