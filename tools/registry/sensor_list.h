// The sensors of the program: the only place that names them all.
#pragma once

#include <vector>

#include "sim/api/sensor_kind.h"

namespace slipbench {

// In the order of `slipbench list`, without registered sensors.
const std::vector<SensorKind>& sensor_catalogue();

}  // namespace slipbench
