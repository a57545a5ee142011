// A patch of piezoelectric polymer under a compliant skin, whose charge follows normal and
// tangential force.
#pragma once

#include "sim/api/sensor_kind.h"

namespace slipbench {

// A piezo_skin with one channel "signal" {1} [counts]. Its pad is the contact under the touching
// tip, one unit of n elements. +X is the long side of the patch, +Z points into the skin, the
// origin is at the mean height of the undeformed contact. create() throws SceneValueError if the
// rate is not a multiple of the position sensor's rate, InputError for unknown or repeated
// electronics.
SensorKind piezo_skin_sensor();

}  // namespace slipbench
