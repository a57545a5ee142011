// A flat grid of custom taxels: each reads its force along three axes and its displacement.
#pragma once

#include "sim/api/sensor_kind.h"

namespace slipbench {

SensorKind taxels_sensor();

}  // namespace slipbench
