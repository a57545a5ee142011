// A flat grid of taxels of one's own: each reads its force along three axes and how far it has moved.
#pragma once

#include "sim/core/sensor_kind.h"

namespace slipbench {

SensorKind taxels_sensor();

}  // namespace slipbench
