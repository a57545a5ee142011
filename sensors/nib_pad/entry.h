// What the catalogue says of the nib pad.
#pragma once

#include "sim/core/parameters.h"
#include "sim/core/sensor_view.h"

namespace slipbench::nib_pad {

Entry about();
SensorView view();

}  // namespace slipbench::nib_pad
