// The pads of the engine plugin `slipbench.field`, for those who step the model themselves.
#pragma once

#include <mujoco/mujoco.h>

#include "sim/mujoco/pads/pad_group.h"
#include "sim/mujoco/pads/pad_instance.h"

namespace slipbench {

// The pad of a plugin instance in `data`; null when the instance is another plugin's.
PadInstance* pad_of(const mjModel* model, const mjData* data, int instance);

// What all pads of `data` share; null when there is none.
PadGroup* pad_group_of(const mjModel* model, const mjData* data);

}  // namespace slipbench
